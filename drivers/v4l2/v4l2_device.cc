// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_device.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <utility>

#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

namespace {

// A device that never says "no more" is cut off here. Cameras list a dozen formats of two dozen sizes.
constexpr std::uint32_t kMaxFormats = 64;
constexpr std::uint32_t kMaxSizes = 64;
constexpr std::uint32_t kMaxRates = 32;
constexpr int kMaxSide = 16384;
constexpr std::size_t kMaxLine = 1500;  // characters

/// Text of a fixed field that may lack its terminating zero, or hold anything else.
template <typename T, std::size_t N>
std::string field_text(const T (&field)[N]) {
  std::string text;
  for (std::size_t i = 0; i < N && field[i] != 0; ++i) {
    const auto c = static_cast<unsigned char>(field[i]);
    text += c < 32 || c == 127 ? '?' : static_cast<char>(c);
  }
  return text;
}

Status open_error(const std::string& path, int error) {
  switch (-error) {
    case EACCES:
    case EPERM: return {ErrorCode::kIo, path + ": " + errno_text(error) + "; add the user to the group that owns it (video)"};
    case EBUSY: return {ErrorCode::kUnavailable, path + ": in use by another program"};
    default: return {ErrorCode::kUnavailable, path + ": " + errno_text(error)};
  }
}

bool is_size(std::uint32_t side) { return side >= 1 && side <= kMaxSide; }

std::optional<V4l2SizeRange> size_range(const v4l2_frmsizeenum& size) {
  if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
    if (!is_size(size.discrete.width) || !is_size(size.discrete.height)) return std::nullopt;
    const int width = static_cast<int>(size.discrete.width), height = static_cast<int>(size.discrete.height);
    return V4l2SizeRange{width, width, 1, height, height, 1};
  }
  const v4l2_frmsize_stepwise& s = size.stepwise;
  for (const std::uint32_t side : {s.min_width, s.max_width, s.min_height, s.max_height}) {
    if (!is_size(side)) return std::nullopt;
  }
  if (s.min_width > s.max_width || s.min_height > s.max_height) return std::nullopt;
  const auto step = [](std::uint32_t given) { return is_size(given) ? static_cast<int>(given) : 1; };
  return V4l2SizeRange{static_cast<int>(s.min_width),  static_cast<int>(s.max_width),  step(s.step_width),
                       static_cast<int>(s.min_height), static_cast<int>(s.max_height), step(s.step_height)};
}

/// Frames a second of an interval in seconds; 0 where that is nonsense.
double rate_hz(const v4l2_fract& interval) {
  return interval.numerator == 0 || interval.denominator == 0 ? 0 : static_cast<double>(interval.denominator) / interval.numerator;
}

std::string rates_text(const std::vector<V4l2RateRange>& rates) {
  if (rates.empty()) return "";
  std::string text = " (";
  char number[64];
  for (const V4l2RateRange& rate : rates) {
    if (rate.min_hz == rate.max_hz) {
      std::snprintf(number, sizeof(number), "%.4g ", rate.min_hz);
    } else {
      std::snprintf(number, sizeof(number), "%.4g-%.4g ", rate.min_hz, rate.max_hz);
    }
    text += number;
  }
  return text + "Hz)";
}

std::string size_text(const V4l2SizeRange& size) {
  const std::string largest = std::to_string(size.max_width) + "x" + std::to_string(size.max_height);
  if (size.is_one()) return largest;
  return std::to_string(size.min_width) + "x" + std::to_string(size.min_height) + "-" + largest;
}

std::string sizes_text(const std::vector<V4l2SizeOffer>& sizes) {
  std::string text;
  for (const V4l2SizeOffer& offer : sizes) text += " " + size_text(offer.size) + rates_text(offer.rates);
  return text;
}

}  // namespace

Result<V4l2Device> V4l2Device::open(V4l2Io& io, const std::string& path) {
  const int fd = io.open(path);
  if (fd < 0) return open_error(path, fd);
  V4l2Device device(path, V4l2Fd(io, fd));
  v4l2_capability capability{};
  if (const int error = device.ioctl(VIDIOC_QUERYCAP, &capability); error != 0) {
    if (error == -ENODEV || error == -EIO) return Status(ErrorCode::kUnavailable, path + ": " + errno_text(error));
    return Status(ErrorCode::kUnsupported, path + ": not a video device (" + errno_text(error) + ")");
  }
  device.card_ = field_text(capability.card);
  device.driver_ = field_text(capability.driver);
  device.bus_ = field_text(capability.bus_info);
  // A driver's capabilities are those of all its nodes; those of this one have a field of their own.
  const bool has_own = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = has_own ? capability.device_caps : capability.capabilities;
  if ((can & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) == 0) {
    return Status(ErrorCode::kUnsupported, path + ": this node of '" + device.card_ + "' gives no images; take another of the same device");
  }
  if ((can & V4L2_CAP_STREAMING) == 0) return Status(ErrorCode::kUnsupported, path + ": '" + device.card_ + "' does not stream");
  device.is_multiplanar_ = (can & V4L2_CAP_VIDEO_CAPTURE) == 0;
  return device;
}

std::uint32_t V4l2Device::buffer_type() const { return is_multiplanar_ ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE; }

std::vector<V4l2FormatOffer> V4l2Device::offers() const {
  std::vector<V4l2FormatOffer> offers;
  for (std::uint32_t index = 0; index < kMaxFormats; ++index) {
    v4l2_fmtdesc format{};
    format.index = index;
    format.type = buffer_type();
    if (ioctl(VIDIOC_ENUM_FMT, &format) != 0) break;
    offers.push_back({format.pixelformat, size_offers(format.pixelformat)});
  }
  return offers;
}

std::vector<V4l2SizeOffer> V4l2Device::size_offers(std::uint32_t fourcc) const {
  std::vector<V4l2SizeOffer> offers;
  for (std::uint32_t index = 0; index < kMaxSizes; ++index) {
    v4l2_frmsizeenum size{};
    size.index = index;
    size.pixel_format = fourcc;
    if (ioctl(VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
    const std::optional<V4l2SizeRange> range = size_range(size);
    if (range) offers.push_back({*range, rate_offers(fourcc, range->max_width, range->max_height)});
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) break;  // a range is the only entry
  }
  return offers;
}

std::vector<V4l2RateRange> V4l2Device::rate_offers(std::uint32_t fourcc, int width, int height) const {
  std::vector<V4l2RateRange> offers;
  for (std::uint32_t index = 0; index < kMaxRates; ++index) {
    v4l2_frmivalenum interval{};
    interval.index = index;
    interval.pixel_format = fourcc;
    interval.width = static_cast<std::uint32_t>(width);
    interval.height = static_cast<std::uint32_t>(height);
    if (ioctl(VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) break;
    const bool is_one = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const double min_hz = rate_hz(is_one ? interval.discrete : interval.stepwise.max);
    const double max_hz = rate_hz(is_one ? interval.discrete : interval.stepwise.min);
    if (min_hz > 0 && max_hz >= min_hz) offers.push_back({min_hz, max_hz});
    if (!is_one) break;
  }
  return offers;
}

std::string offers_line(const std::vector<V4l2FormatOffer>& offers) {
  if (offers.empty()) return "no format at all";
  // Most cameras have the same sizes in several formats.
  std::vector<std::pair<std::string, std::string>> groups;  // formats, sizes
  for (const V4l2FormatOffer& offer : offers) {
    const std::string sizes = sizes_text(offer.sizes), name = fourcc_name(offer.fourcc);
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.second == sizes; });
    if (group == groups.end()) {
      groups.emplace_back(name, sizes);
    } else {
      group->first += ", " + name;
    }
  }
  std::string line;
  for (const auto& [names, sizes] : groups) {
    if (line.size() + names.size() + sizes.size() > kMaxLine) return line + (line.empty() ? "" : "; ") + names + " and more";
    line += (line.empty() ? "" : "; ") + names + sizes;
  }
  return line;
}

}  // namespace camloc
