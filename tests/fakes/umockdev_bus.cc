// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/umockdev_bus.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <set>

#include "tests/fakes/ready_fifo.h"

namespace camloc::fakes {
namespace {

constexpr const char* kRootHub = "/sys/devices/pci0000:00/0000:00:14.0/usb1";

/// What the ioctl handler of one device file needs; belongs to it, and it lives while clients have the file open.
struct Port {
  UsbfsHost* host = nullptr;
  UsbDeviceId device = UsbDeviceId::kCamera;
  std::string device_file;
  std::shared_ptr<ReadyFifo> fifo;
};

/// The other end of one of this process's connections.
struct Peer {
  pid_t pid = 0;
  UniqueFd connection;  ///< a duplicate, which hangs up when the client closes its file or dies
};

/// Finds the connection of a client that has just opened `device_file`. umockdev tells neither whose ioctl it hands over nor reliably
/// that a client went, but each open file has a connection of its own, whose local name ends with the device file's.
class PeerFinder {
 public:
  [[nodiscard]] Peer take(const std::string& device_file) {
    Peer newest;
    std::set<ino_t> present;
    DIR* const folder = ::opendir("/proc/self/fd");
    if (folder == nullptr) return newest;
    while (const dirent* const entry = ::readdir(folder)) {
      const int fd = std::atoi(entry->d_name);
      const pid_t pid = peer_of(fd, device_file);
      struct stat info {};
      if (pid == 0 || ::fstat(fd, &info) != 0) continue;
      present.insert(info.st_ino);
      if (taken_.contains({device_file, info.st_ino})) continue;
      newest = {pid, UniqueFd(::fcntl(fd, F_DUPFD_CLOEXEC, 0))};
    }
    ::closedir(folder);
    // Forget those that are gone: their numbers come again.
    std::erase_if(taken_, [&](const auto& known) { return known.first == device_file && !present.contains(known.second); });
    struct stat info {};
    if (newest.pid != 0 && ::fstat(newest.connection.get(), &info) == 0) taken_.insert({device_file, info.st_ino});
    return newest;
  }

 private:
  [[nodiscard]] static pid_t peer_of(int fd, const std::string& device_file) {
    sockaddr_un name{};
    socklen_t size = sizeof name;
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&name), &size) != 0 || name.sun_family != AF_UNIX) return 0;
    name.sun_path[sizeof name.sun_path - 1] = '\0';
    if (!std::string_view(name.sun_path).ends_with(device_file)) return 0;
    ucred peer{};
    socklen_t peer_size = sizeof peer;
    int is_listening = 0;
    socklen_t flag_size = sizeof is_listening;
    ::getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &is_listening, &flag_size);
    if (is_listening != 0 || ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &peer_size) != 0) return 0;
    return peer.pid;
  }

  std::set<std::pair<std::string, ino_t>> taken_;
};

PeerFinder& peers() {
  static PeerFinder finder;  // used by umockdev's thread alone
  return finder;
}

std::string hex(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string four_digits(unsigned value) {
  char text[8];
  std::snprintf(text, sizeof text, "%04x", value & 0xffffU);
  return text;
}

std::string device_file_of(int number) {
  char text[32];
  std::snprintf(text, sizeof text, "/dev/bus/usb/001/%03d", number);
  return text;
}

/// A device in umockdev's text format, with what libusb, udev rules and lsusb read.
std::string device_text(const std::string& path, int number, const UsbDescriptors& d) {
  const auto attribute = [](const std::string& name, const std::string& value) { return "A: " + name + "=" + value + "\\n\n"; };
  std::string text = "P: " + path.substr(4) + "\nN: " + device_file_of(number).substr(5) + "\n";
  text += "E: DEVNAME=" + device_file_of(number) + "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\n";
  text += "E: DEVNUM=" + device_file_of(number).substr(17) + "\nE: MAJOR=189\nE: MINOR=" + std::to_string(number - 1) + "\n";
  text += "E: ID_VENDOR_ID=" + four_digits(d.vendor_id()) + "\nE: ID_MODEL_ID=" + four_digits(d.product_id()) + "\n";
  text += "E: PRODUCT=" + four_digits(d.vendor_id()) + "/" + four_digits(d.product_id()) + "/" + four_digits(d.release_bcd()) + "\n";
  text += attribute("busnum", "1") + attribute("devnum", std::to_string(number)) + attribute("speed", "480") +
          attribute("bConfigurationValue", "1") + attribute("bNumConfigurations", "1") + attribute("idVendor", four_digits(d.vendor_id())) +
          attribute("idProduct", four_digits(d.product_id())) + attribute("bcdDevice", four_digits(d.release_bcd()));
  if (!d.strings.empty()) text += attribute("product", d.strings[0]);
  if (!d.serial().empty()) text += attribute("serial", d.serial());
  std::vector<std::uint8_t> both = d.device;
  both.insert(both.end(), d.configuration.begin(), d.configuration.end());
  return text + "H: descriptors=" + hex(both) + "\n";
}

UsbDescriptors hub_descriptors(unsigned vendor, unsigned product) {
  const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value & 0xff); };
  UsbDescriptors d;
  d.device = {18, 1, 0x00, 0x02, 9, 0, 1, 64, byte(vendor), byte(vendor >> 8), byte(product), byte(product >> 8), 0, 1, 0, 0, 0, 1};
  d.configuration = {9, 2, 25, 0, 1, 1, 0, 0xe0, 50, 9, 4, 0, 0, 1, 9, 0, 0, 0, 7, 5, 0x81, 3, 1, 0, 12};
  return d;
}

}  // namespace
}  // namespace camloc::fakes

// ---- the handler, a GObject; GLib's macros want plain names ----

struct CamlocUsbHandler {
  UMockdevIoctlBase parent;
  camloc::fakes::Port* port;
};
struct CamlocUsbHandlerClass {
  UMockdevIoctlBaseClass parent;
};
GType camloc_usb_handler_get_type();
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
G_DEFINE_TYPE(CamlocUsbHandler, camloc_usb_handler, UMOCKDEV_TYPE_IOCTL_BASE)
#pragma GCC diagnostic pop

namespace {

void on_connected(UMockdevIoctlBase* base, UMockdevIoctlClient* client) {
  const camloc::fakes::Port& port = *reinterpret_cast<CamlocUsbHandler*>(base)->port;
  camloc::fakes::Peer peer = camloc::fakes::peers().take(port.device_file);
  port.host->open_session(client, port.device, peer.pid, std::move(peer.connection),
                          [fifo = port.fifo](bool is_ready) { fifo->set_ready(is_ready); });
}

gboolean handle_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client) {
  const camloc::fakes::Port& port = *reinterpret_cast<CamlocUsbHandler*>(base)->port;
  guint8* bytes = nullptr;
  gint size = 0;
  umockdev_ioctl_data_retrieve(umockdev_ioctl_client_get_arg(client), &bytes, &size);
  std::uint64_t argument = 0;
  std::memcpy(&argument, bytes, std::min(sizeof argument, static_cast<std::size_t>(size)));
  g_free(bytes);
  const camloc::fakes::IoctlResult result = port.host->ioctl(client, umockdev_ioctl_client_get_request(client), argument);
  umockdev_ioctl_client_complete(client, result.value, result.error);
  return TRUE;
}

}  // namespace

static void finalize_handler(GObject* object) {
  delete reinterpret_cast<CamlocUsbHandler*>(object)->port;
  G_OBJECT_CLASS(camloc_usb_handler_parent_class)->finalize(object);
}

static void camloc_usb_handler_class_init(CamlocUsbHandlerClass* type) {
  reinterpret_cast<GObjectClass*>(type)->finalize = finalize_handler;
  type->parent.handle_ioctl = handle_ioctl;
  type->parent.client_connected = on_connected;
}
static void camloc_usb_handler_init(CamlocUsbHandler* handler) { handler->port = nullptr; }

namespace camloc::fakes {

struct UmockdevBus::Impl {
  struct Device {
    std::string path;  ///< in sysfs
    int number = 0;
    CamlocUsbHandler* handler = nullptr;  ///< none for hubs
  };

  KinectRig* rig = nullptr;
  UsbfsHost* host = nullptr;
  bool has_motor = false;
  UMockdevTestbed* testbed = nullptr;
  std::vector<Device> plugged;
  int next_number = 2;

  [[nodiscard]] Status add(const std::string& path, int number, const UsbDescriptors& descriptors);
  [[nodiscard]] Status attach(Device* device, UsbDeviceId id);
  [[nodiscard]] Status plug_in(const std::string& path, const UsbDescriptors& descriptors, std::optional<UsbDeviceId> id);
};

Status UmockdevBus::Impl::add(const std::string& path, int number, const UsbDescriptors& descriptors) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed, device_text(path, number, descriptors).c_str(), &error) != 0) return {};
  const Status status(ErrorCode::kInvalid, path + ": umockdev refuses it: " + error->message);
  g_error_free(error);
  return status;
}

Status UmockdevBus::Impl::attach(Device* device, UsbDeviceId id) {
  const std::string file = device_file_of(device->number);
  gchar* const root = umockdev_testbed_get_root_dir(testbed);
  auto fifo = ReadyFifo::create(std::string(root) + file);
  g_free(root);
  if (!fifo) return fifo.status();
  device->handler = static_cast<CamlocUsbHandler*>(g_object_new(camloc_usb_handler_get_type(), nullptr));
  device->handler->port = new Port{host, id, file, std::make_shared<ReadyFifo>(std::move(*fifo))};
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed, file.c_str(), &device->handler->parent, &error) != 0) return {};
  const Status status(ErrorCode::kInvalid, file + ": umockdev takes no ioctls for it: " + error->message);
  g_error_free(error);
  return status;
}

Status UmockdevBus::Impl::plug_in(const std::string& path, const UsbDescriptors& descriptors, std::optional<UsbDeviceId> id) {
  Device device{path, next_number, nullptr};
  constexpr int kLastNumber = 127, kFirstNumber = 2;
  next_number = next_number == kLastNumber ? kFirstNumber : next_number + 1;
  if (const Status status = add(device.path, device.number, descriptors); !status) return status;
  if (id) {
    if (const Status status = attach(&device, *id); !status) return status;
  }
  plugged.push_back(device);
  umockdev_testbed_uevent(testbed, path.c_str(), "add");
  return {};
}

UmockdevBus::UmockdevBus(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<UmockdevBus>> UmockdevBus::create(KinectRig* rig, UsbfsHost* host, bool has_motor) {
  const char* const preloaded = ::getenv("LD_PRELOAD");  // umockdev_in_mock_environment() of 0.17 always says no
  if (preloaded == nullptr || std::strstr(preloaded, "libumockdev-preload") == nullptr)
    return {ErrorCode::kInvalid, "umockdev is not loaded; start with: umockdev-wrapper fake-kinect ..."};
  auto impl = std::make_unique<Impl>();
  impl->rig = rig;
  impl->host = host;
  impl->has_motor = has_motor;
  impl->testbed = umockdev_testbed_new();
  if (const Status status = impl->add(kRootHub, 1, hub_descriptors(0x1d6b, 0x0002)); !status) return status;
  return std::unique_ptr<UmockdevBus>(new UmockdevBus(std::move(impl)));
}

UmockdevBus::~UmockdevBus() {
  for (const Impl::Device& device : impl_->plugged) {
    if (device.handler == nullptr) continue;
    umockdev_testbed_detach_ioctl(impl_->testbed, device_file_of(device.number).c_str(), nullptr);
    g_object_unref(device.handler);
  }
  g_object_unref(impl_->testbed);
}

Status UmockdevBus::replug() {
  if (!impl_->plugged.empty()) return {ErrorCode::kInvalid, "the Kinect is plugged in already"};
  const std::string hub = std::string(kRootHub) + "/1-1";
  if (const Status status = impl_->plug_in(hub, hub_descriptors(0x0409, 0x005a), std::nullopt); !status) return status;
  if (impl_->has_motor) {
    if (const Status status = impl_->plug_in(hub + "/1-1.1", impl_->rig->device(UsbDeviceId::kMotor).descriptors(), UsbDeviceId::kMotor);
        !status)
      return status;
  }
  return impl_->plug_in(hub + "/1-1.3", impl_->rig->device(UsbDeviceId::kCamera).descriptors(), UsbDeviceId::kCamera);
}

Status UmockdevBus::unplug() {
  if (impl_->plugged.empty()) return {ErrorCode::kInvalid, "the Kinect is not plugged in"};
  impl_->host->disconnect();
  // The kernel takes children first; open files stay valid and get ENODEV from the host.
  while (!impl_->plugged.empty()) {
    const Impl::Device device = impl_->plugged.back();
    impl_->plugged.pop_back();
    const std::string file = device_file_of(device.number);
    gchar* const root = umockdev_testbed_get_root_dir(impl_->testbed);
    ::unlink((std::string(root) + file).c_str());
    g_free(root);
    umockdev_testbed_uevent(impl_->testbed, device.path.c_str(), "remove");
    umockdev_testbed_remove_device(impl_->testbed, device.path.c_str());
    if (device.handler == nullptr) continue;
    umockdev_testbed_detach_ioctl(impl_->testbed, file.c_str(), nullptr);  // no new clients; numbers come again
    g_object_unref(device.handler);
  }
  return {};
}

}  // namespace camloc::fakes
