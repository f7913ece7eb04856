// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/dense/thumbnail.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camloc {
namespace {

// What still belongs to the nearest surface in a cell; a floor some metres ahead does.
constexpr float kSameSurfaceShare = 1.08F, kSameSurfaceM = 0.01F;
constexpr std::uint32_t kMinSamples = 2;

}  // namespace

ThumbnailMaker::ThumbnailMaker(const RgbdCamera& camera) : camera_(camera), depth_rays_(camera.depth) {}

// Half of the columns and rows, those that lie symmetrically in cells of four and eight pixels: the mean of the samples is then
// that of the cell. Every fourth where each has to be projected.
void ThumbnailMaker::sample_depth(ImageView<std::uint16_t> depth, const Thumbnail& thumbnail) {
  samples_.clear();
  const Eigen::Matrix3d R_color_depth = camera_.T_color_depth.rotation.toRotationMatrix();
  const auto next = [&](int i) { return camera_.is_depth_registered ? i + (i % 4 == 0 ? 3 : 1) : i + 4; };
  const int first = camera_.is_depth_registered ? 0 : 2;
  for (int y = first; y < depth.height; y = next(y)) {
    for (int x = first; x < depth.width; x = next(x)) {
      float z = camera_.depth_m(depth.at(x, y));
      if (z <= 0) continue;
      Eigen::Vector2d pixel(x, y);
      if (!camera_.is_depth_registered) {
        const Eigen::Vector2f ray = depth_rays_.undistort(static_cast<float>(x), static_cast<float>(y));
        const Eigen::Vector3d p_color = R_color_depth * (z * Eigen::Vector3d(ray.x(), ray.y(), 1)) + camera_.T_color_depth.translation;
        if (p_color.z() < 0.05) continue;
        pixel = camera_.color.project(p_color);
        z = static_cast<float>(p_color.z());
      }
      const double column = std::floor((pixel.x() + 0.5) / thumbnail.cell_px), row = std::floor((pixel.y() + 0.5) / thumbnail.cell_px);
      if (!(column >= 0 && row >= 0 && column < thumbnail.width && row < thumbnail.height)) continue;
      samples_.push_back({static_cast<std::uint32_t>(thumbnail.index(static_cast<int>(column), static_cast<int>(row))), z});
    }
  }
}

Thumbnail ThumbnailMaker::make(const Frame& frame) {
  Thumbnail thumbnail;
  const int cell = thumbnail.cell_px = std::max((frame.gray.width + Thumbnail::kColumns - 1) / Thumbnail::kColumns, 1);
  thumbnail.width = frame.gray.width / cell;
  thumbnail.height = frame.gray.height / cell;
  const std::size_t count = thumbnail.index(0, thumbnail.height);
  thumbnail.grey.resize(count);
  const float to_units = 1.0F / (Thumbnail::kGreyUnit * static_cast<float>(cell * cell));
  for (int row = 0; row < thumbnail.height; ++row) {
    for (int column = 0; column < thumbnail.width; ++column) {
      std::uint32_t sum = 0;
      for (int y = row * cell; y < (row + 1) * cell; ++y) {
        const std::uint8_t* pixels = frame.gray.row(y) + column * cell;
        for (int x = 0; x < cell; ++x) sum += pixels[x];
      }
      thumbnail.grey[thumbnail.index(column, row)] = static_cast<std::uint16_t>(std::lround(to_units * static_cast<float>(sum)));
    }
  }
  sample_depth(frame.depth, thumbnail);
  nearest_m_.assign(count, std::numeric_limits<float>::infinity());
  sum_per_m_.assign(count, 0);
  counts_.assign(count, 0);
  for (const Sample& s : samples_) nearest_m_[s.cell] = std::min(nearest_m_[s.cell], s.z_m);
  for (const Sample& s : samples_) {
    if (s.z_m > kSameSurfaceShare * nearest_m_[s.cell] + kSameSurfaceM) continue;
    sum_per_m_[s.cell] += 1 / s.z_m;
    ++counts_[s.cell];
  }
  thumbnail.depth.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (counts_[i] < kMinSamples) continue;
    const float units = static_cast<float>(counts_[i]) / sum_per_m_[i] / Thumbnail::kDepthUnitM;
    if (units < 65535) thumbnail.depth[i] = static_cast<std::uint16_t>(std::lround(units));
  }
  return thumbnail;
}

}  // namespace camloc
