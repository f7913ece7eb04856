// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/depth_sensor.h"

#include <algorithm>
#include <cmath>

namespace camloc::sim {

DepthNoise expected_noise(const DepthSensorOptions& options) {
  // A step of d px in disparity is d z^2 / (f b) in depth; rounding to it adds a uniform error.
  const double step_per_m = options.disparity_step_px / (options.focal_px * options.baseline_m);
  return {0.0005, std::hypot(options.noise_per_m, step_per_m / std::sqrt(12.0))};
}

void DepthSensor::mark_shadows(const Rendering& rendering, int y) {
  // The projector sits to the right: a point at disparity d appears to it at column x - d (scaled to colour pixels). A point
  // whose column is already passed by something nearer, further right in the image, lies in its shadow.
  const int width = intrinsics_.width;
  is_shadowed_.assign(static_cast<std::size_t>(width), 0);
  const float scale = static_cast<float>(intrinsics_.fx * options_.baseline_m);
  float leftmost = 1e9F;
  for (int x = width - 1; x >= 0; --x) {
    const float z = rendering.depth_m.at(x, y);
    const float column = static_cast<float>(x) - (z > 0.0F ? scale / z : 0.0F);
    if (column > leftmost + 0.5F) is_shadowed_[static_cast<std::size_t>(x)] = 1;
    leftmost = std::min(leftmost, column);
  }
}

void DepthSensor::measure_exactly(const Rendering& rendering, Image<std::uint16_t>* depth) const {
  for (std::size_t i = 0; i < depth->pixels.size(); ++i) {
    const double raw = std::round(rendering.depth_m.pixels[i] / options_.unit_m);
    depth->pixels[i] = raw < 65535.0 ? static_cast<std::uint16_t>(raw) : std::uint16_t{0};
  }
}

void DepthSensor::measure(const Rendering& rendering, const Renderer& renderer, std::uint32_t frame_seed, Image<std::uint16_t>* depth) {
  depth->resize(intrinsics_.width, intrinsics_.height);
  if (options_.is_perfect) return measure_exactly(rendering, depth);
  const int width = intrinsics_.width, height = intrinsics_.height;
  const float focal_baseline = static_cast<float>(options_.focal_px * options_.baseline_m);
  const float sigma_px = static_cast<float>(options_.noise_per_m) * focal_baseline;
  const float step = static_cast<float>(options_.disparity_step_px);
  Xorshift random(hash32(frame_seed, 2));
  for (int y = 0; y < height; ++y) {
    mark_shadows(rendering, y);
    for (int x = 0; x < width; ++x) {
      const std::uint32_t bits = random(), more_bits = random();
      // Matching windows cover several pixels: now and then a neighbour's depth wins, which frays edges.
      const int from_x = std::clamp(x + static_cast<int>((bits >> 3) % 5U) - 2, 0, width - 1),
                from_y = std::clamp(y + static_cast<int>((bits >> 9) % 3U) - 1, 0, height - 1);
      const bool strays = (bits & 7U) == 0U;
      const bool is_edge = rendering.surface.at(from_x, from_y) != rendering.surface.at(x, y);
      const float z = strays ? rendering.depth_m.at(from_x, from_y) : rendering.depth_m.at(x, y);
      std::uint16_t& out = depth->at(x, y);
      out = 0;
      if (z < static_cast<float>(options_.min_m) || z > static_cast<float>(options_.max_m)) continue;
      if (is_shadowed_[static_cast<std::size_t>(x)] != 0U) continue;
      if (is_edge && std::fabs(rendering.depth_m.at(from_x, from_y) - rendering.depth_m.at(x, y)) > 0.02F * z && (bits >> 16) % 4U == 0U)
        continue;
      // Little light comes back at a grazing angle, and from far away; shiny things answer in patches.
      const float cosine = rendering.cosine.at(x, y);
      const bool is_unfriendly = is_depth_unfriendly(renderer.seen_surface(rendering.surface.at(x, y)).skin.material);
      if (is_unfriendly || cosine < 0.18F + 0.02F * z) {
        const float patch = value_noise(static_cast<float>(x) * 0.15F, static_cast<float>(y) * 0.15F, frame_seed);
        if (cosine < 0.10F + 0.08F * patch + 0.02F * z || (is_unfriendly && patch > -0.35F)) continue;
      }
      const float disparity = focal_baseline / z + sigma_px * normal_(more_bits);
      const float stepped = step * std::floor(disparity / step + 0.5F);
      const float measured = focal_baseline / std::max(stepped, step);
      const float raw = measured / static_cast<float>(options_.unit_m);
      if (raw < 65534.0F) out = static_cast<std::uint16_t>(raw + 0.5F);
    }
  }
}

}  // namespace camloc::sim
