// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_opening.h"

#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "core/io/camera_file.h"
#include "drivers/v4l2/v4l2_controls.h"
#include "drivers/v4l2/v4l2_negotiation.h"
#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

namespace {

/// One node and what is wanted of it.
struct V4l2NodeSettings {
  std::string node;  ///< path, link, or "serial:XXXX"; empty: not wanted
  V4l2Wish wish;
  std::map<std::string, std::string> controls;
};

/// The options "control.NAME" as NAME -> value, taken out of `options`.
std::map<std::string, std::string> take_controls(const std::string& prefix, std::map<std::string, std::string>* options) {
  std::map<std::string, std::string> controls;
  for (auto option = options->lower_bound(prefix); option != options->end() && option->first.starts_with(prefix);
       option = options->erase(option)) {
    controls.emplace(option->first.substr(prefix.size()), option->second);
  }
  return controls;
}

Status format_option(const SourceUrl& url, const std::string& key, std::optional<std::uint32_t>* fourcc) {
  if (!url.options.contains(key)) return Status::ok();
  const std::string name = url.text_option(key, "");
  *fourcc = parse_fourcc(name);
  if (*fourcc) return Status::ok();
  std::string known;
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) known += (known.empty() ? "" : ", ") + fourcc_name(format.fourcc);
  return {ErrorCode::kInvalid, url.text + ": option " + key + "=" + name + ": expected one of " + known};
}

/// Size and rate: the depth node is wished to be like the image, and required to be only where depth_ options say so.
Status read_wish(const SourceUrl& url, const std::string& prefix, V4l2Wish* wish) {
  OptionReader options(url);
  wish->width = options.whole(prefix + "width", wish->width, 2, 16384);
  wish->height = options.whole(prefix + "height", wish->height, 2, 16384);
  wish->rate_hz = options.number(prefix + "rate_hz", wish->rate_hz, 0.1, 1000);
  wish->is_width_required = options.has(prefix + "width");
  wish->is_height_required = options.has(prefix + "height");
  wish->is_rate_required = options.has(prefix + "rate_hz");
  return options.status() ? format_option(url, prefix + "format", &wish->fourcc) : options.status();
}

Status read_camera(const SourceUrl& url, std::optional<RgbdCamera>* result) {
  const std::string path = url.text_option("camera", "");
  OptionReader options(url);
  const std::optional<double> unit_m = options.given_number("depth_unit_m", 1e-6, 0.1);
  if (!options.status()) return options.status();
  if (path.empty()) {
    if (!unit_m) return Status::ok();
    return {ErrorCode::kInvalid, url.text + ": depth_unit_m belongs to a calibration; name it, too: camera=FILE"};
  }
  Result<RgbdCamera> camera = read_camera_file(path);
  if (!camera) return camera.status();
  if (unit_m) camera->depth_unit_m = *unit_m;
  *result = *camera;
  return Status::ok();
}

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
    if (Status status = read_options(options); !status) return status;
    if (image_.node.empty() && depth_.node.empty()) return no_node_named(url_, *opened_.io, folders_);
    for (V4l2NodeSettings* node : {&image_, &depth_}) {
      if (node->node.empty()) continue;
      if (Status status = open_node(node); !status) return status;
    }
    opened_.gives_color = options.wants_color && opened_.image && opened_.image->layout().format->has_color;
    FrameSourceInfo& info = opened_.info;
    info.stamp_clock = StampClock::kMonotonic;
    if (opened_.image) info.color_width = opened_.image->layout().width, info.color_height = opened_.image->layout().height;
    if (opened_.depth) info.depth_width = opened_.depth->layout().width, info.depth_height = opened_.depth->layout().height;
    for (V4l2Stream* stream : {opened_.image.get(), opened_.depth.get()}) {
      if (stream == nullptr) continue;
      if (Status status = stream->start(); !status) return status;
    }
    return std::move(opened_);
  }

 private:
  Status read_options(const FrameSourceOptions& options) {
    SourceUrl plain = url_;
    image_.controls = take_controls("control.", &plain.options);
    depth_.controls = take_controls("depth_control.", &plain.options);
    if (Status status = plain.check_options({"depth", "width", "height", "rate_hz", "format", "depth_width", "depth_height",
                                             "depth_rate_hz", "depth_format", "gray_bits", "stamp_offset_ms", "camera", "depth_unit_m",
                                             "control.NAME", "depth_control.NAME"});
        !status) {
      return status;
    }
    image_.node = url_.path;
    depth_.node = url_.text_option("depth", "");
    image_.wish.prefers_color = options.wants_color;
    if (Status status = read_wish(url_, "", &image_.wish); !status) return status;
    depth_.wish = image_.wish;
    depth_.wish.role = V4l2Role::kDepth;
    depth_.wish.fourcc.reset();
    if (Status status = read_wish(url_, "depth_", &depth_.wish); !status) return status;
    OptionReader reader(url_);
    const int gray_bits = reader.whole("gray_bits", 8, 8, 16);
    if (reader.has("gray_bits")) opened_.gray_bits = static_cast<unsigned>(gray_bits);
    opened_.stamp_offset_ns = std::llround(reader.number("stamp_offset_ms", 0, -1000, 1000) * 1e6);
    return reader.status() ? read_camera(url_, &opened_.info.camera) : reader.status();
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
    if (node->wish.role == V4l2Role::kImage && depth_.node.empty()) node->wish.role = role_of_only_node(*device, node->wish);
    Result<std::unique_ptr<V4l2Stream>> stream = open_stream(std::move(device).value(), *node);
    if (!stream) return stream.status();
    (node->wish.role == V4l2Role::kImage ? opened_.image : opened_.depth) = std::move(stream).value();
    return Status::ok();
  }

  const SourceUrl& url_;
  const SystemFolders& folders_;
  V4l2NodeSettings image_;  // the node of the URL's path; may turn out to be the only one and to give depth
  V4l2NodeSettings depth_;
  V4l2Opened opened_;
  std::string first_path_;
};

}  // namespace

Result<V4l2Opened> open_v4l2_nodes(std::shared_ptr<V4l2Io> io, const SystemFolders& folders, const SourceUrl& url,
                                   const FrameSourceOptions& options) {
  return Opener(std::move(io), folders, url).open(options);
}

}  // namespace camloc
