// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_negotiation.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "core/io/image_file.h"

namespace camloc {

namespace {

constexpr double kRateTolerance = 0.02;  // 29.97 is 30
constexpr std::size_t kMaxStrideBytes = std::size_t{1} << 20;

struct Choice {
  const V4l2PixelFormat* format = nullptr;
  int width = 0, height = 0;
  double rate_hz = 0;  ///< 0: not told
  std::tuple<bool, int, unsigned, std::ptrdiff_t> cost;
};

std::string wish_text(const V4l2Wish& wish) {
  std::string text = wish.role == V4l2Role::kDepth ? "depth" : "images";
  if (wish.fourcc) text += " as " + fourcc_name(*wish.fourcc);
  const auto side = [](bool is_required, int value) { return is_required ? std::to_string(value) : "any"; };
  if (wish.is_width_required || wish.is_height_required) {
    text += " of " + side(wish.is_width_required, wish.width) + "x" + side(wish.is_height_required, wish.height);
  }
  char rate[32];
  std::snprintf(rate, sizeof(rate), " at %.4g Hz", wish.rate_hz);
  return wish.is_rate_required ? text + rate : text;
}

Status nothing_fits(const V4l2Device& device, const V4l2Wish& wish, const std::vector<V4l2FormatOffer>& offers) {
  return {ErrorCode::kUnsupported,
          device.path() + ": '" + device.card() + "' does not offer " + wish_text(wish) + "; it offers " + offers_line(offers)};
}

bool is_rate(double rate_hz, double wanted_hz) { return std::abs(rate_hz - wanted_hz) <= kRateTolerance * wanted_hz; }

/// The offered rate nearest to the wish; 0 where none is offered.
double nearest_rate_hz(const std::vector<V4l2RateRange>& rates, double wanted_hz) {
  double best = 0;
  for (const V4l2RateRange& range : rates) {
    const double rate_hz = std::clamp(wanted_hz, range.min_hz, range.max_hz);
    if (best == 0 || std::abs(rate_hz - wanted_hz) < std::abs(best - wanted_hz)) best = rate_hz;
  }
  return best;
}

int snapped(int wanted, int low, int high, int step) { return low + (std::clamp(wanted, low, high) - low) / step * step; }

bool size_satisfies(const V4l2Wish& wish, int width, int height) {
  return (!wish.is_width_required || width == wish.width) && (!wish.is_height_required || height == wish.height);
}

/// Where a driver lists no rates, what takes less of the bus is what comes faster: a Kinect sends Bayer pixels at 30 Hz, UYVY at 15.
unsigned bits_on_the_bus(const V4l2PixelFormat& format) { return format.row_bits == 0 ? 16 : format.row_bits; }

/// The cheapest way to take one size offer, where it fulfils what is required. Cost: too slow, far from the size, then format.
std::optional<Choice> consider(const V4l2Device& device, const V4l2Wish& wish, const V4l2PixelFormat& format, const V4l2SizeOffer& offer) {
  const V4l2SizeRange& s = offer.size;
  Choice choice;
  choice.format = &format;
  choice.width = snapped(wish.width, s.min_width, s.max_width, s.step_width);
  choice.height = snapped(wish.height, s.min_height, s.max_height, s.step_height);
  if (!size_satisfies(wish, choice.width, choice.height)) return std::nullopt;
  const bool is_listed = s.is_one() && !offer.rates.empty();
  const std::vector<V4l2RateRange> rates = is_listed ? offer.rates : device.rate_offers(format.fourcc, choice.width, choice.height);
  choice.rate_hz = nearest_rate_hz(rates, wish.rate_hz);
  const bool is_told = choice.rate_hz > 0;
  if (is_told && wish.is_rate_required && !is_rate(choice.rate_hz, wish.rate_hz)) return std::nullopt;
  const bool is_slow = is_told && choice.rate_hz < 0.9 * wish.rate_hz;
  const bool is_colorless = wish.prefers_color && !format.has_color;
  const std::ptrdiff_t rank = &format - v4l2_pixel_formats().data() + (is_colorless ? 1000 : 0);
  // For depth the sure formats are at the end of the table.
  choice.cost = {is_slow, std::abs(choice.width - wish.width) + std::abs(choice.height - wish.height),
                 is_told || wish.role == V4l2Role::kDepth ? 0 : bits_on_the_bus(format), wish.role == V4l2Role::kDepth ? -rank : rank};
  return choice;
}

std::optional<Choice> choose(const V4l2Device& device, const V4l2Wish& wish, const std::vector<V4l2FormatOffer>& offers) {
  std::optional<Choice> best;
  // A driver that lists no sizes has to be asked for one.
  const std::vector<V4l2SizeOffer> as_wished{{{wish.width, wish.width, 1, wish.height, wish.height, 1}, {}}};
  for (const V4l2FormatOffer& offer : offers) {
    const V4l2PixelFormat* format = find_v4l2_pixel_format(offer.fourcc);
    if (format == nullptr || !format->fits(wish.role) || (wish.fourcc && *wish.fourcc != offer.fourcc)) continue;
    for (const V4l2SizeOffer& size : offer.sizes.empty() ? as_wished : offer.sizes) {
      const std::optional<Choice> choice = consider(device, wish, *format, size);
      if (choice && (!best || choice->cost < best->cost)) best = choice;
    }
  }
  return best;
}

/// The answer to VIDIOC_S_FMT, whichever of the two APIs it came through.
struct Answer {
  std::uint32_t width, height, fourcc, field, num_planes;
  std::array<std::uint32_t, 2> stride, plane_bytes;
  std::uint32_t colorspace, ycbcr_enc, quantization;
};

Answer answer_of(const v4l2_format& format, bool is_multiplanar) {
  const auto common = [](const auto& p) {
    return Answer{p.width, p.height, p.pixelformat, p.field, 1, {}, {}, p.colorspace, p.ycbcr_enc, p.quantization};
  };
  if (is_multiplanar) {
    const v4l2_pix_format_mplane& p = format.fmt.pix_mp;
    Answer answer = common(p);
    answer.num_planes = p.num_planes;
    answer.stride = {p.plane_fmt[0].bytesperline, p.plane_fmt[1].bytesperline};
    answer.plane_bytes = {p.plane_fmt[0].sizeimage, p.plane_fmt[1].sizeimage};
    return answer;
  }
  const v4l2_pix_format& p = format.fmt.pix;
  Answer answer = common(p);
  answer.stride[0] = p.bytesperline;
  answer.plane_bytes[0] = p.sizeimage;
  const bool has_extension = p.priv == V4L2_PIX_FMT_PRIV_MAGIC;
  if (!has_extension) answer.ycbcr_enc = answer.quantization = 0;
  return answer;
}

YuvEncoding encoding_of(const Answer& answer) {
  YuvEncoding encoding;
  encoding.is_bt709 =
      answer.ycbcr_enc == V4L2_YCBCR_ENC_709 || (answer.ycbcr_enc == V4L2_YCBCR_ENC_DEFAULT && answer.colorspace == V4L2_COLORSPACE_REC709);
  encoding.is_full_range = answer.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
                           (answer.quantization == V4L2_QUANTIZATION_DEFAULT && answer.colorspace == V4L2_COLORSPACE_JPEG);
  return encoding;
}

Status contradiction(const V4l2Device& device, const std::string& what) {
  return {ErrorCode::kCorrupt, device.path() + ": the driver (" + device.driver() + ") contradicts itself: " + what};
}

Status check_kind(const V4l2Device& device, const Choice& choice, const Answer& answer) {
  const bool is_as_asked = answer.fourcc == choice.format->fourcc && answer.width == static_cast<std::uint32_t>(choice.width) &&
                           answer.height == static_cast<std::uint32_t>(choice.height);
  if (!is_as_asked) {
    return {ErrorCode::kUnsupported, device.path() + ": asked for " + fourcc_name(choice.format->fourcc) + " " +
                                         std::to_string(choice.width) + "x" + std::to_string(choice.height) + ", the device sets " +
                                         fourcc_name(answer.fourcc) + " " + std::to_string(answer.width) + "x" +
                                         std::to_string(answer.height) + "; ask for that (format=, width=, height=)"};
  }
  const bool is_progressive = answer.field == V4L2_FIELD_NONE || answer.field == V4L2_FIELD_ANY || answer.field == V4L2_FIELD_INTERLACED ||
                              answer.field == V4L2_FIELD_INTERLACED_TB || answer.field == V4L2_FIELD_INTERLACED_BT;
  if (!is_progressive)
    return {ErrorCode::kUnsupported, device.path() + ": the device gives single fields of interlaced video, not whole frames"};
  if (answer.num_planes != choice.format->num_planes) {
    return contradiction(device, fourcc_name(answer.fourcc) + " in " + std::to_string(answer.num_planes) + " planes");
  }
  return check_image_size(choice.width, choice.height, device.path());
}

/// Rows that are long enough, buffers that hold them.
Result<V4l2ImageLayout> checked_layout(const V4l2Device& device, const Choice& choice, const Answer& answer) {
  if (Status status = check_kind(device, choice, answer); !status) return status;
  V4l2ImageLayout layout{choice.format, choice.width, choice.height, {}, encoding_of(answer)};
  if (choice.format->layout == PixelLayout::kBayer && (choice.width < 2 || choice.height < 2)) {
    return contradiction(device, "a Bayer mosaic of less than 2x2 pixels");
  }
  for (unsigned plane = 0; plane < choice.format->num_planes; ++plane) {
    const std::size_t row = min_row_bytes(*choice.format, choice.width);
    const std::size_t stride = answer.stride[plane] == 0 || row == 0 ? row : answer.stride[plane];  // 0: no padding
    if (stride < row || stride > kMaxStrideBytes) {
      return contradiction(device, "rows of " + std::to_string(stride) + " bytes for " + std::to_string(choice.width) + " pixels of " +
                                       fourcc_name(answer.fourcc) + ", which take " + std::to_string(row));
    }
    layout.stride_bytes[plane] = stride;
    const std::size_t bytes = answer.plane_bytes[plane], needed = layout.plane_bytes(plane);
    if (bytes < std::max<std::size_t>(needed, 1) || bytes > kMaxV4l2BufferBytes) {
      return contradiction(device, "buffers of " + std::to_string(bytes) + " bytes for frames of " + std::to_string(needed));
    }
  }
  return layout;
}

Result<V4l2ImageLayout> set_format(const V4l2Device& device, const Choice& choice) {
  v4l2_format format{};
  format.type = device.buffer_type();
  const auto ask = [&choice](auto* pixels) {
    pixels->width = static_cast<std::uint32_t>(choice.width);
    pixels->height = static_cast<std::uint32_t>(choice.height);
    pixels->pixelformat = choice.format->fourcc;
    pixels->field = V4L2_FIELD_NONE;
  };
  if (device.is_multiplanar()) {
    ask(&format.fmt.pix_mp);
    format.fmt.pix_mp.num_planes = static_cast<std::uint8_t>(choice.format->num_planes);
  } else {
    ask(&format.fmt.pix);
    format.fmt.pix.priv = V4L2_PIX_FMT_PRIV_MAGIC;
  }
  const int error = device.ioctl(VIDIOC_S_FMT, &format);
  if (error == -EBUSY) return Status(ErrorCode::kUnavailable, device.path() + ": in use by another program");
  if (error == -EINVAL) return Status(ErrorCode::kUnsupported, device.path() + ": the device refuses the format that it lists");
  if (error != 0) return Status(ErrorCode::kUnavailable, device.path() + ": " + errno_text(error));
  return checked_layout(device, choice, answer_of(format, device.is_multiplanar()));
}

/// Sets the rate where the device can, and tells the one that it will keep; 0: it does not tell.
double set_rate(const V4l2Device& device, double wanted_hz) {
  v4l2_streamparm parameters{};
  parameters.type = device.buffer_type();
  parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(wanted_hz * 1000))};
  if (device.ioctl(VIDIOC_S_PARM, &parameters) != 0) return 0;
  if ((parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return 0;  // some only echo what was asked for
  const v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (interval.numerator == 0 || interval.denominator == 0) return 0;
  const double rate_hz = static_cast<double>(interval.denominator) / interval.numerator;
  return rate_hz >= 0.01 && rate_hz <= 10000 ? rate_hz : 0;
}

}  // namespace

Result<V4l2Agreement> negotiate_v4l2(const V4l2Device& device, const V4l2Wish& wish) {
  const std::vector<V4l2FormatOffer> offers = device.offers();
  const std::optional<Choice> choice = choose(device, wish, offers);
  if (!choice) return nothing_fits(device, wish, offers);
  const Result<V4l2ImageLayout> layout = set_format(device, *choice);
  if (!layout) return layout.status();
  const double set_hz = set_rate(device, choice->rate_hz > 0 ? choice->rate_hz : wish.rate_hz);
  if (set_hz > 0 && wish.is_rate_required && !is_rate(set_hz, wish.rate_hz)) return nothing_fits(device, wish, offers);
  const double told_hz = set_hz > 0 ? set_hz : choice->rate_hz;
  return V4l2Agreement{*layout, told_hz > 0 || !wish.is_rate_required ? told_hz : wish.rate_hz};
}

}  // namespace camloc
