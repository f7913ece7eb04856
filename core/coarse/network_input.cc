// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/network_input.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace camloc {
namespace {

constexpr float kDepthScale = 1.0F / 5.0F;

/// Distorted pixel of the ray. Where the model folds back (strong distortion far outside of the image) the last pixel on the way
/// from the centre that it still reaches: it lies outside, and on the same side.
Eigen::Vector2d distort_without_fold(const Intrinsics& camera, const Eigen::Vector2d& ray) {
  constexpr int kSteps = 32;
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  Eigen::Vector2d farthest = centre;
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector2d pixel = camera.distort(static_cast<double>(i) / kSteps * ray);
    if ((pixel - centre).squaredNorm() < (farthest - centre).squaredNorm()) break;
    farthest = pixel;
  }
  return farthest;
}

}  // namespace

Status NetworkInputLayout::validate() const {
  const auto wrong = [](const std::string& what) { return Status(ErrorCode::kInvalid, what); };
  if (channels < 1 || channels > 4) return wrong(std::to_string(channels) + " channels; a network here sees 1 to 4");
  if (width < 8 || width > 1024 || height < 8 || height > 1024)
    return wrong("an input of " + std::to_string(width) + " x " + std::to_string(height) + " pixels; sides are 8 to 1024");
  if (!(focal_px > 0 && focal_px < 1e5F)) return wrong("the focal length of the network's input is not a positive number of pixels");
  if (!std::isfinite(mean) || !std::isfinite(scale) || scale == 0) return wrong("mean or scale of the network's input is no number");
  return Status::ok();
}

/// An interval of pixels on one axis: those that it touches, and how much of the first and the last.
struct NetworkInput::Span {
  int first = 0, count = 1;
  double first_part = 1, last_part = 1, length = 1;
  double centre = 0;
  bool is_inside = true;

  /// `width_px` around `middle`, cut off at the image; where nothing is left, the edge's pixel.
  Span(double middle, double width_px, int size) : centre(std::clamp(middle, 0.0, size - 1.0)) {
    is_inside = middle >= -0.5 && middle <= size - 0.5;
    // Pixel i reaches from i to i + 1 here.
    double from = std::clamp(middle + 0.5 - 0.5 * width_px, 0.0, static_cast<double>(size));
    double to = std::clamp(middle + 0.5 + 0.5 * width_px, 0.0, static_cast<double>(size));
    if (to - from < 0.25) {
      from = middle < 0.5 * size ? 0 : size - 1;
      to = from + 1;
    }
    first = std::min(static_cast<int>(from), size - 1);
    count = std::max(static_cast<int>(std::ceil(to)), first + 1) - first;
    first_part = count == 1 ? to - from : first + 1 - from;
    last_part = count == 1 ? first_part : to - (first + count - 1);
    length = to - from;
  }
};

NetworkInput::Footprint NetworkInput::footprint_of(const Span& x, const Span& y) {
  Footprint out;
  out.x = static_cast<std::uint16_t>(x.first), out.num_x = static_cast<std::uint16_t>(x.count);
  out.y = static_cast<std::uint16_t>(y.first), out.num_y = static_cast<std::uint16_t>(y.count);
  out.first_x = static_cast<float>(x.first_part), out.last_x = static_cast<float>(x.last_part);
  out.first_y = static_cast<float>(y.first_part), out.last_y = static_cast<float>(y.last_part);
  out.inverse_area = static_cast<float>(1.0 / (x.length * y.length));
  out.centre_u = static_cast<float>(x.centre), out.centre_v = static_cast<float>(y.centre);
  out.is_inside = x.is_inside && y.is_inside;
  return out;
}

NetworkInput::NetworkInput(const RgbdCamera& camera, const NetworkInputLayout& layout) : camera_(camera), layout_(layout) {
  assert(layout.validate());
  const Intrinsics& color = camera.color;
  const double step = 1.0 / layout.focal_px;
  footprints_.reserve(static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height));
  for (int v = 0; v < layout.height; ++v) {
    for (int u = 0; u < layout.width; ++u) {
      const Eigen::Vector2d ray((u - 0.5 * (layout.width - 1)) * step, (v - 0.5 * (layout.height - 1)) * step);
      const Eigen::Vector2d middle = distort_without_fold(color, ray);
      const double width_px = std::abs(distort_without_fold(color, ray + Eigen::Vector2d(0.5 * step, 0)).x() -
                                       distort_without_fold(color, ray - Eigen::Vector2d(0.5 * step, 0)).x());
      const double height_px = std::abs(distort_without_fold(color, ray + Eigen::Vector2d(0, 0.5 * step)).y() -
                                        distort_without_fold(color, ray - Eigen::Vector2d(0, 0.5 * step)).y());
      // One pixel's width at least: the mean of a moving pixel's width is linear interpolation.
      footprints_.push_back(
          footprint_of(Span(middle.x(), std::max(width_px, 1.0), color.width), Span(middle.y(), std::max(height_px, 1.0), color.height)));
    }
  }
  if (layout.has_depth() && !camera.is_depth_registered) depth_lookup_.emplace(camera);
}

float NetworkInput::mean_gray(const Footprint& footprint, ImageView<std::uint8_t> gray) {
  float sum = 0;
  for (int j = 0; j < footprint.num_y; ++j) {
    const std::uint8_t* row = gray.row(footprint.y + j) + footprint.x;
    float row_sum = footprint.first_x * row[0];
    int between = 0;
    for (int i = 1; i < footprint.num_x - 1; ++i) between += row[i];
    row_sum += static_cast<float>(between);
    if (footprint.num_x > 1) row_sum += footprint.last_x * row[footprint.num_x - 1];
    sum += (j == 0 ? footprint.first_y : j == footprint.num_y - 1 ? footprint.last_y : 1.0F) * row_sum;
  }
  return sum * footprint.inverse_area;
}

float NetworkInput::mean_depth_m(const Footprint& footprint, ImageView<std::uint16_t> depth) const {
  if (depth.empty() || !footprint.is_inside) return 0;
  float sum = 0;
  int count = 0;
  for (int j = footprint.y; j < std::min(footprint.y + footprint.num_y, depth.height); ++j) {
    for (int i = footprint.x; i < std::min(footprint.x + footprint.num_x, depth.width); ++i) {
      const float z = camera_.depth_m(depth.at(i, j));
      sum += z;
      count += z > 0 ? 1 : 0;
    }
  }
  return count > 0 ? sum / static_cast<float>(count) : 0;
}

/// A look-up takes half a microsecond: not one a pixel, but one a block, for 3072 blocks at most.
void NetworkInput::look_up_depth(ImageView<std::uint16_t> depth, std::span<float> out) const {
  constexpr double kMaxLookups = 3072;
  const int block = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(footprints_.size()) / kMaxLookups)));
  const auto width = static_cast<std::size_t>(layout_.width);
  for (int y = 0; y < layout_.height; y += block) {
    for (int x = 0; x < layout_.width; x += block) {
      const int x_end = std::min(x + block, layout_.width), y_end = std::min(y + block, layout_.height);
      const Footprint& middle =
          footprints_[static_cast<std::size_t>((y + y_end - 1) / 2) * width + static_cast<std::size_t>((x + x_end - 1) / 2)];
      const float z = middle.is_inside && !depth.empty() ? depth_lookup_->depth_at(depth, middle.centre_u, middle.centre_v) : 0;
      for (int j = y; j < y_end; ++j) {
        const auto row = out.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(j) * width);
        std::fill(row + x, row + x_end, kDepthScale * z);
      }
    }
  }
}

void NetworkInput::fill(const Frame& frame, std::span<float> out) const {
  assert(out.size() == size());
  if (frame.gray.empty() || frame.gray.width != camera_.color.width || frame.gray.height != camera_.color.height) {
    std::fill(out.begin(), out.end(), 0.0F);
    return;
  }
  const std::size_t plane = footprints_.size();
  const std::span<float> gray = out.first(plane);
  for (std::size_t i = 0; i < plane; ++i) gray[i] = (mean_gray(footprints_[i], frame.gray) - layout_.mean) * layout_.scale;
  const auto num_gray = static_cast<std::size_t>(layout_.num_gray());
  for (std::size_t c = 1; c < num_gray; ++c) std::copy(gray.begin(), gray.end(), out.subspan(c * plane, plane).begin());
  if (!layout_.has_depth()) return;
  const std::span<float> depth = out.subspan(num_gray * plane, plane);
  if (depth_lookup_) return look_up_depth(frame.depth, depth);
  for (std::size_t i = 0; i < plane; ++i) depth[i] = kDepthScale * mean_depth_m(footprints_[i], frame.depth);
}

}  // namespace camloc
