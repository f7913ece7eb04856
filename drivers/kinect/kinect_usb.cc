// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_usb.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <span>
#include <vector>

#include "drivers/kinect/kinect_protocol.h"
#include "drivers/usb_devices.h"

namespace camloc::kinect {

namespace {

class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) : size_(libusb_get_device_list(context, &devices_)) {}
  ~DeviceList() {
    if (size_ >= 0) libusb_free_device_list(devices_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  [[nodiscard]] std::span<libusb_device* const> devices() const { return {devices_, size_ > 0 ? static_cast<std::size_t>(size_) : 0}; }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t size_;
};

/// `count` elements, or none where libusb has none: it keeps the count of a descriptor that was cut off in its middle.
template <typename T>
std::span<const T> elements(const T* first, int count) {
  return first != nullptr && count > 0 ? std::span<const T>(first, static_cast<std::size_t>(count)) : std::span<const T>();
}

std::optional<libusb_device_descriptor> descriptor_of(libusb_device* device) {
  libusb_device_descriptor descriptor{};
  if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) return std::nullopt;
  return descriptor;
}

constexpr std::array<std::uint16_t, 2> kCameras{kProductCamera, kProductCameraK4w};
constexpr std::array<std::uint16_t, 1> kMotors{kProductMotor};

std::vector<libusb_device*> devices_of(const DeviceList& list, std::span<const std::uint16_t> products) {
  std::vector<libusb_device*> found;
  for (libusb_device* device : list.devices()) {
    const auto descriptor = descriptor_of(device);
    if (!descriptor || descriptor->idVendor != kVendorMicrosoft) continue;
    if (std::find(products.begin(), products.end(), descriptor->idProduct) != products.end()) found.push_back(device);
  }
  return found;
}

std::string location_of(libusb_device* device) {
  std::string text = "bus " + std::to_string(libusb_get_bus_number(device));
  std::array<std::uint8_t, 8> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (depth <= 0) return text + " device " + std::to_string(libusb_get_device_address(device));
  for (int i = 0; i < depth; ++i) text += (i == 0 ? " port " : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  return text;
}

/// Printable ASCII only: a serial number goes into messages and URLs.
std::string serial_of(libusb_device_handle* handle, std::uint8_t string_index) {
  std::array<unsigned char, 64> text{};
  if (string_index == 0) return {};
  const int length = libusb_get_string_descriptor_ascii(handle, string_index, text.data(), static_cast<int>(text.size()));
  std::string serial;
  for (int i = 0; i < length; ++i) {
    const unsigned char c = text[static_cast<std::size_t>(i)];
    if (c > 0x20 && c < 0x7f) serial += static_cast<char>(c);
  }
  return serial;
}

bool are_siblings(libusb_device* a, libusb_device* b) {
  libusb_device* const hub = libusb_get_parent(a);
  return hub != nullptr && hub == libusb_get_parent(b);
}

// Cameras of model 1473 all say 0000000000000000, but the audio device in the same housing has a number of its own.
std::string serial_of_audio(const DeviceList& list, libusb_device* camera) {
  for (libusb_device* device : devices_of(list, kProductsAudio)) {
    if (!are_siblings(device, camera)) continue;
    libusb_device_handle* handle = nullptr;
    if (libusb_open(device, &handle) != LIBUSB_SUCCESS) continue;
    const UsbHandle owner(handle);
    const std::string serial = serial_of(handle, descriptor_of(device)->iSerialNumber);
    if (!is_placeholder_serial(serial)) return serial;
  }
  return {};
}

std::optional<std::size_t> index_in(const std::string& selector) {
  if (selector.empty()) return 0;
  if (selector.size() > 2 || selector.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return static_cast<std::size_t>(std::stoi(selector));
}

Result<OpenCamera> open_one(const DeviceList& list, libusb_device* device) {
  libusb_device_handle* handle = nullptr;
  errno = 0;
  const int code = libusb_open(device, &handle);
  if (code != LIBUSB_SUCCESS) return usb_error(code, errno, "Kinect camera at " + location_of(device));
  OpenCamera camera;
  camera.handle.reset(handle);
  const libusb_device_descriptor descriptor = *descriptor_of(device);
  camera.product = descriptor.idProduct;
  camera.release = descriptor.bcdDevice;
  camera.location = location_of(device);
  camera.serial = serial_of(handle, descriptor.iSerialNumber);
  if (is_placeholder_serial(camera.serial)) camera.serial = serial_of_audio(list, device);
  return camera;
}

Status nothing_attached(const DeviceList& list) {
  if (!devices_of(list, kMotors).empty()) {
    return {ErrorCode::kUnavailable, "no Kinect camera is attached, only its motor: the camera needs the 12 V power supply"};
  }
  if (!devices_of(list, kProductsAudio).empty()) {
    return {ErrorCode::kUnavailable, "no Kinect camera is attached, only its audio device: plug it in again, check the power supply"};
  }
  return {ErrorCode::kUnavailable,
          "no Kinect is attached (" + std::to_string(list.devices().size()) + " USB devices, none of them 045e:02ae or 045e:02bf)"};
}

}  // namespace

std::string OpenCamera::model() const {
  if (product == kProductCameraK4w) return "Kinect for Windows V1";
  return release == kReleaseOf1414 ? "Kinect model 1414" : "Kinect model 1473";
}

Status usb_error(int code, int system_error, const std::string& what) {
  switch (code) {
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND: return {ErrorCode::kUnavailable, what + ": the device is gone"};
    case LIBUSB_ERROR_ACCESS:
      return {ErrorCode::kIo, what + ": no permission; install the udev rule 60-camloc.rules (package camloc), or join the group plugdev"};
    case LIBUSB_ERROR_BUSY: return {ErrorCode::kUnavailable, what + ": another program is using it"};
    case LIBUSB_ERROR_TIMEOUT: return {ErrorCode::kTimeout, what + ": the device does not answer"};
    default: break;
  }
  if (code == LIBUSB_ERROR_NO_MEM || system_error == ENOMEM) {
    return {ErrorCode::kIo, what + ": not enough memory for USB transfers; raise /sys/module/usbcore/parameters/usbfs_memory_mb"};
  }
  if (system_error == ENOSPC) {
    return {ErrorCode::kIo,
            what + ": not enough USB bandwidth; plug the Kinect into a USB controller of its own, or take other cameras off this one"};
  }
  return {ErrorCode::kIo, what + ": " + libusb_strerror(code)};
}

Result<OpenCamera> open_camera(libusb_context* context, const std::string& selector) {
  const DeviceList list(context);
  std::vector<libusb_device*> cameras = devices_of(list, kCameras);
  if (cameras.empty()) return nothing_attached(list);
  std::sort(cameras.begin(), cameras.end(), [](libusb_device* a, libusb_device* b) {
    return std::pair(libusb_get_bus_number(a), libusb_get_device_address(a)) <
           std::pair(libusb_get_bus_number(b), libusb_get_device_address(b));
  });
  if (const auto index = index_in(selector)) {
    if (*index < cameras.size()) return open_one(list, cameras[*index]);
    return Status(ErrorCode::kUnavailable, "no Kinect with index " + selector + ": " + std::to_string(cameras.size()) + " attached");
  }
  std::string others;
  std::optional<Status> problem;
  for (libusb_device* device : cameras) {
    Result<OpenCamera> camera = open_one(list, device);
    if (!camera) {
      problem = camera.status();
      continue;
    }
    if (camera->serial == selector) return camera;
    others += (others.empty() ? "" : ", ") + (camera->serial.empty() ? "one without serial at " + camera->location : camera->serial);
  }
  if (others.empty() && problem) return *problem;
  return Status(ErrorCode::kUnavailable, "no Kinect with serial " + selector + "; attached: " + others);
}

UsbHandle open_motor(libusb_context* context, libusb_device* camera) {
  const DeviceList list(context);
  const std::vector<libusb_device*> motors = devices_of(list, kMotors);
  const bool is_only_kinect = motors.size() == 1 && devices_of(list, kCameras).size() == 1;
  for (libusb_device* device : motors) {
    if (!is_only_kinect && !are_siblings(device, camera)) continue;
    libusb_device_handle* handle = nullptr;
    if (libusb_open(device, &handle) == LIBUSB_SUCCESS) return UsbHandle(handle);
  }
  return nullptr;
}

Result<StreamSetting> find_stream_setting(libusb_device* camera) {
  libusb_config_descriptor* config = nullptr;
  const int code = libusb_get_active_config_descriptor(camera, &config);
  if (code != LIBUSB_SUCCESS) return usb_error(code, 0, "Kinect camera, USB descriptors");
  const std::unique_ptr<libusb_config_descriptor, UsbDeleter<libusb_free_config_descriptor>> owner(config);
  std::optional<StreamSetting> best;
  for (const libusb_interface& interface : elements(config->interface, config->bNumInterfaces)) {
    for (const libusb_interface_descriptor& alternate : elements(interface.altsetting, interface.num_altsetting)) {
      if (alternate.bInterfaceNumber != kCameraInterface) continue;
      StreamSetting setting{alternate.bAlternateSetting, 0, 0};
      for (const libusb_endpoint_descriptor& endpoint : elements(alternate.endpoint, alternate.bNumEndpoints)) {
        if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_ISOCHRONOUS) continue;
        const int bytes = (endpoint.wMaxPacketSize & 0x7ff) * (1 + (endpoint.wMaxPacketSize >> 11 & 3));  // USB 2.0, 9.6.6
        if (endpoint.bEndpointAddress == kColorEndpoint) setting.color_packet_bytes = bytes;
        if (endpoint.bEndpointAddress == kDepthEndpoint) setting.depth_packet_bytes = bytes;
      }
      const bool carries_both = setting.color_packet_bytes >= static_cast<int>(kPacketHeaderBytes + kColorPayloadBytes) &&
                                setting.depth_packet_bytes >= static_cast<int>(kPacketHeaderBytes + kDepthPayloadBytes);
      if (carries_both && !best) best = setting;
    }
  }
  if (!best)
    return Status(ErrorCode::kUnsupported,
                  "Kinect camera: its USB descriptors offer no endpoints for both streams; plug it in again, try another cable");
  return *best;
}

}  // namespace camloc::kinect
