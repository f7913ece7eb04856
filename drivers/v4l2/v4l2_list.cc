// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// /sys/class/video4linux/videoN/device is the USB interface of a camera; the folders above it are the USB device, with its
// serial, and its place on the bus.
#include "drivers/v4l2/v4l2_list.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "core/io/text.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxLevels = 8;           // from an interface to its device; two in practice
constexpr std::size_t kMaxNodes = 256;  // minors of a character device

/// The USB device that the node hangs on.
std::optional<UsbDevice> usb_device_of(const std::string& name, const SystemFolders& folders) {
  std::error_code error;
  fs::path folder = fs::canonical(fs::path(folders.path("/sys/class/video4linux")) / name / "device", error);
  if (error) return std::nullopt;
  for (int level = 0; level < kMaxLevels && folder.has_relative_path(); ++level, folder = folder.parent_path()) {
    if (fs::exists(folder / "busnum", error) && fs::exists(folder / "devnum", error)) return read_usb_device(folder);
  }
  return std::nullopt;
}

/// N of "videoN".
std::optional<std::int64_t> node_number(const std::string& name) {
  return name.starts_with("video") ? parse_int(std::string_view(name).substr(5)) : std::nullopt;
}

std::vector<std::string> node_names(const SystemFolders& folders) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folders.path("/sys/class/video4linux"), error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (node_number(name) && names.size() < kMaxNodes) names.push_back(name);
  }
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) { return *node_number(a) < *node_number(b); });
  return names;
}

/// How well a node fits: 0 not at all.
int fitness(const V4l2DeviceInfo& node, V4l2Role role) {
  int best = 0;
  for (const V4l2FormatOffer& offer : node.formats) {
    const V4l2PixelFormat* format = find_v4l2_pixel_format(offer.fourcc);
    if (format == nullptr || !format->fits(role)) continue;
    const bool is_sure = role == V4l2Role::kImage ? format->has_color : !format->can_be_image;
    best = std::max(best, is_sure ? 2 : 1);
  }
  return best;
}

}  // namespace

V4l2DeviceInfo describe_v4l2_node(const std::string& path, const SystemFolders& folders) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  V4l2DeviceInfo info;
  info.path = error || real.empty() ? path : real.string();
  const std::string name = fs::path(info.path).filename().string();
  info.name = read_system_attribute(fs::path(folders.path("/sys/class/video4linux")) / name / "name");
  if (const std::optional<UsbDevice> device = usb_device_of(name, folders)) {
    info.serial = device->serial;
    info.usb_node = folders.path(device->node());
  }
  return info;
}

std::vector<V4l2DeviceInfo> list_v4l2_devices(V4l2Io& io, const SystemFolders& folders) {
  std::vector<V4l2DeviceInfo> nodes;
  for (const std::string& name : node_names(folders)) {
    V4l2DeviceInfo info = describe_v4l2_node(folders.path("/dev/" + name), folders);
    const Result<V4l2Device> device = V4l2Device::open(io, info.path);
    if (!device && device.status().code() == ErrorCode::kUnsupported) continue;
    if (device) {
      info.name = device->card();
      info.bus = device->bus();
      info.formats = device->offers();
    } else {
      info.problem = device.status().message();
    }
    nodes.push_back(std::move(info));
  }
  return nodes;
}

CameraListing list_v4l2_cameras(V4l2Io& io, const SystemFolders& folders) {
  CameraListing listing{
      {}, folders.path("/sys/class/video4linux"), "", "plug it in, then 'ls -l /dev/v4l/by-id'; the nodes belong to the group video"};
  for (const V4l2DeviceInfo& device : list_v4l2_devices(io, folders)) {
    listing.cameras.push_back({"v4l2://" + (device.serial.empty() ? device.path : "serial:" + device.serial), device.name,
                               device.path + (device.bus.empty() ? "" : ", " + device.bus), device.problem});
  }
  return listing;
}

CameraListing list_v4l2_cameras(const SystemFolders& folders) { return list_v4l2_cameras(*make_system_v4l2_io(), folders); }

Result<std::string> find_v4l2_node(V4l2Io& io, const SystemFolders& folders, const std::string& serial, V4l2Role role) {
  const V4l2DeviceInfo* best = nullptr;
  int best_fitness = 0;
  std::string others;
  bool is_there = false;
  const std::vector<V4l2DeviceInfo> nodes = list_v4l2_devices(io, folders);
  for (const V4l2DeviceInfo& node : nodes) {
    if (node.serial != serial) {
      if (!node.serial.empty() && others.find(node.serial) == std::string::npos) others += (others.empty() ? "" : ", ") + node.serial;
      continue;
    }
    if (!node.problem.empty()) return Status(ErrorCode::kUnavailable, node.problem);
    is_there = true;
    if (const int fits = fitness(node, role); fits > best_fitness) best = &node, best_fitness = fits;
  }
  if (best != nullptr) return best->path;
  if (is_there) {
    return Status(ErrorCode::kUnsupported, "the camera with serial " + in_quotes(serial) + " offers no " +
                                               (role == V4l2Role::kDepth ? "depth" : "image") + " format that is read here");
  }
  return Status(ErrorCode::kUnavailable, "no camera with serial " + in_quotes(serial) + " is plugged in; there is " +
                                             (others.empty() ? "none with a serial" : others));
}

}  // namespace camloc
