// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See v4l2_opening.h.
#include "drivers/v4l2/v4l2_opening.h"

#include <string_view>
#include <utility>

#include "drivers/v4l2/v4l2_controls.h"

namespace camloc {

namespace {

/// The path of a node that may be named by its serial.
Result<std::string> resolve_node(V4l2Io& io, const SystemFolders& folders, const V4l2NodeSettings& node) {
  constexpr std::string_view kSerial = "serial:";
  if (!node.node.starts_with(kSerial)) return node.node;
  return find_v4l2_node(io, folders, node.node.substr(kSerial.size()), node.wish.role);
}

Result<std::unique_ptr<V4l2Stream>> open_stream(V4l2Device device, const V4l2NodeSettings& node) {
  const Result<V4l2Agreement> agreement = negotiate_v4l2(device, node.wish);
  if (!agreement) return agreement.status();
  if (Status status = set_v4l2_controls(device, node.controls); !status) return status;
  return V4l2Stream::open(std::move(device), *agreement);
}

/// A node alone may turn out to give depth: by the format asked for, or because it offers nothing else.
V4l2Role role_of_only_node(const V4l2Device& device, const V4l2Wish& wish) {
  if (wish.fourcc) return find_v4l2_pixel_format(*wish.fourcc)->can_be_image ? V4l2Role::kImage : V4l2Role::kDepth;
  bool gives_depth = false;
  for (const V4l2FormatOffer& offer : device.offers()) {
    const V4l2PixelFormat* format = find_v4l2_pixel_format(offer.fourcc);
    if (format == nullptr) continue;
    if (format->can_be_image) return V4l2Role::kImage;
    gives_depth = gives_depth || format->can_be_depth;
  }
  return gives_depth ? V4l2Role::kDepth : V4l2Role::kImage;
}

Status no_node_named(const SourceUrl& url, V4l2Io& io, const SystemFolders& folders) {
  std::string there;
  for (const V4l2DeviceInfo& node : list_v4l2_devices(io, folders))
    there += (there.empty() ? "" : ", ") + node.path + " '" + node.name + "'";
  return {ErrorCode::kInvalid,
          url.text + ": names no camera; expected v4l2:///dev/videoN or v4l2://serial:XXXX; there is " + (there.empty() ? "none" : there)};
}

class Opener {
 public:
  Opener(std::shared_ptr<V4l2Io> io, const SystemFolders& folders, const SourceUrl& url) : url_(url), folders_(folders) {
    opened_.io = std::move(io);
  }

  Result<V4l2Opened> open(const FrameSourceOptions& options) {
    Result<V4l2Settings> settings = parse_v4l2_settings(url_, options);
    if (!settings) return settings.status();
    opened_.settings = std::move(settings).value();
    if (Status status = open_streams(); !status) return status;
    opened_.gives_color = options.wants_color && opened_.image && opened_.image->layout().format->has_color;
    fill_info();
    for (V4l2Stream* stream : {opened_.image.get(), opened_.depth.get()}) {
      if (stream == nullptr) continue;
      if (Status status = stream->start(); !status) return status;
    }
    return std::move(opened_);
  }

 private:
  Status open_streams() {
    V4l2Settings& settings = opened_.settings;
    if (settings.image.node.empty() && settings.depth.node.empty()) return no_node_named(url_, *opened_.io, folders_);
    if (!settings.image.node.empty()) {
      if (Status status = open_node(&settings.image); !status) return status;
    }
    if (settings.depth.node.empty()) return Status::ok();
    return open_node(&settings.depth);
  }

  Status open_node(V4l2NodeSettings* node) {
    const Result<std::string> path = resolve_node(*opened_.io, folders_, *node);
    if (!path) return path.status();
    Result<V4l2Device> device = V4l2Device::open(*opened_.io, *path);
    if (!device) return device.status();
    const V4l2DeviceInfo info = describe_v4l2_node(*path, folders_);
    if (info.path == first_path_) return {ErrorCode::kInvalid, url_.text + ": image and depth are one node, which gives one stream"};
    if (first_path_.empty()) {
      first_path_ = info.path;
      opened_.info.serial = info.serial;
      opened_.usb_node = info.usb_node;
    }
    if (node->wish.role == V4l2Role::kImage && opened_.settings.depth.node.empty())
      node->wish.role = role_of_only_node(*device, node->wish);
    Result<std::unique_ptr<V4l2Stream>> stream = open_stream(std::move(device).value(), *node);
    if (!stream) return stream.status();
    (node->wish.role == V4l2Role::kImage ? opened_.image : opened_.depth) = std::move(stream).value();
    return Status::ok();
  }

  void fill_info() {
    FrameSourceInfo& info = opened_.info;
    info.stamp_clock = StampClock::kMonotonic;
    info.camera = opened_.settings.camera;
    if (opened_.image) info.color_width = opened_.image->layout().width, info.color_height = opened_.image->layout().height;
    if (opened_.depth) info.depth_width = opened_.depth->layout().width, info.depth_height = opened_.depth->layout().height;
  }

  const SourceUrl& url_;
  const SystemFolders& folders_;
  V4l2Opened opened_;
  std::string first_path_;
};

}  // namespace

Result<V4l2Opened> open_v4l2_nodes(std::shared_ptr<V4l2Io> io, const SystemFolders& folders, const SourceUrl& url,
                                   const FrameSourceOptions& options) {
  return Opener(std::move(io), folders, url).open(options);
}

}  // namespace camloc
