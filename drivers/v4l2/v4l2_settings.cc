// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See v4l2_settings.h.
#include "drivers/v4l2/v4l2_settings.h"

#include <cmath>

#include "core/io/camera_file.h"
#include "core/io/text.h"
#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

namespace {

constexpr const char* kControl = "control.";
constexpr const char* kDepthControl = "depth_control.";

/// The options "control.NAME" as NAME -> value, taken out of `options`.
std::map<std::string, std::string> take_controls(const std::string& prefix, std::map<std::string, std::string>* options) {
  std::map<std::string, std::string> controls;
  for (auto option = options->lower_bound(prefix); option != options->end() && option->first.starts_with(prefix);
       option = options->erase(option)) {
    controls.emplace(option->first.substr(prefix.size()), option->second);
  }
  return controls;
}

/// A whole number in [low, high] into `value`; false in `is_given` where the option is absent.
Status whole_option(const SourceUrl& url, const std::string& key, int low, int high, int* value, bool* is_given) {
  *is_given = url.options.contains(key);
  const Result<double> number = url.number_option(key, *value, low, high);
  if (!number) return number.status();
  if (*number != std::floor(*number))
    return {ErrorCode::kInvalid, url.text + ": option " + key + "=" + url.options.at(key) + ": expected a whole number"};
  *value = static_cast<int>(*number);
  return Status::ok();
}

Status format_option(const SourceUrl& url, const std::string& key, std::optional<std::uint32_t>* fourcc) {
  const std::string name = url.text_option(key, "");
  if (!url.options.contains(key)) return Status::ok();
  *fourcc = parse_fourcc(name);
  if (*fourcc) return Status::ok();
  std::string known;
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) known += (known.empty() ? "" : ", ") + fourcc_name(format.fourcc);
  return {ErrorCode::kInvalid, url.text + ": option " + key + "=" + name + ": expected one of " + known};
}

/// Size and rate: the depth node is wished to be like the image, and required to be only where depth_ options say so.
Status read_wish(const SourceUrl& url, const std::string& prefix, V4l2Wish* wish) {
  if (Status status = whole_option(url, prefix + "width", 2, 16384, &wish->width, &wish->is_width_required); !status) return status;
  if (Status status = whole_option(url, prefix + "height", 2, 16384, &wish->height, &wish->is_height_required); !status) return status;
  const Result<double> rate_hz = url.number_option(prefix + "rate_hz", wish->rate_hz, 0.1, 1000);
  if (!rate_hz) return rate_hz.status();
  wish->rate_hz = *rate_hz;
  wish->is_rate_required = url.options.contains(prefix + "rate_hz");
  return format_option(url, prefix + "format", &wish->fourcc);
}

Status read_camera(const SourceUrl& url, V4l2Settings* settings) {
  const std::string path = url.text_option("camera", "");
  const Result<double> unit_m = url.number_option("depth_unit_m", 0, 1e-6, 0.1);
  if (!unit_m && url.options.contains("depth_unit_m")) return unit_m.status();
  if (path.empty()) {
    if (!url.options.contains("depth_unit_m")) return Status::ok();
    return {ErrorCode::kInvalid, url.text + ": depth_unit_m belongs to a calibration; name it, too: camera=FILE"};
  }
  Result<RgbdCamera> camera = read_camera_file(path);
  if (!camera) return camera.status();
  if (url.options.contains("depth_unit_m")) camera->depth_unit_m = *unit_m;
  settings->camera = *camera;
  return Status::ok();
}

}  // namespace

Result<V4l2Settings> parse_v4l2_settings(const SourceUrl& url, const FrameSourceOptions& options) {
  V4l2Settings settings;
  SourceUrl plain = url;
  settings.image.controls = take_controls(kControl, &plain.options);
  settings.depth.controls = take_controls(kDepthControl, &plain.options);
  if (Status status = plain.check_options({"depth", "width", "height", "rate_hz", "format", "depth_width", "depth_height", "depth_rate_hz",
                                           "depth_format", "gray_bits", "stamp_offset_ms", "camera", "depth_unit_m", "control.NAME",
                                           "depth_control.NAME"});
      !status) {
    return status;
  }
  settings.image.node = url.path;
  settings.depth.node = url.text_option("depth", "");
  settings.image.wish.prefers_color = options.wants_color;
  if (Status status = read_wish(url, "", &settings.image.wish); !status) return status;
  settings.depth.wish = settings.image.wish;
  settings.depth.wish.role = V4l2Role::kDepth;
  settings.depth.wish.fourcc.reset();
  if (Status status = read_wish(url, "depth_", &settings.depth.wish); !status) return status;

  int gray_bits = 8;
  bool has_gray_bits = false;
  if (Status status = whole_option(url, "gray_bits", 8, 16, &gray_bits, &has_gray_bits); !status) return status;
  if (has_gray_bits) settings.gray_bits = static_cast<unsigned>(gray_bits);
  const Result<double> offset_ms = url.number_option("stamp_offset_ms", 0, -1000, 1000);
  if (!offset_ms) return offset_ms.status();
  settings.stamp_offset_ns = std::llround(*offset_ms * 1e6);
  if (Status status = read_camera(url, &settings); !status) return status;
  return settings;
}

}  // namespace camloc
