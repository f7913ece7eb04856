// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/sensors.h"

#include <algorithm>
#include <cmath>

namespace camloc::sim {
namespace {

constexpr double kDepthUnitM = 0.0002;  // per raw unit: TUM's factor 5000
constexpr double kBaselineM = 0.075;    // camera to projector
constexpr double kFocalPx = 580;        // of the infrared camera
constexpr double kDisparityStepPx = 0.125;
constexpr double kNoisePerM = 0.0015;  // sigma of depth before the steps is kNoisePerM * z^2
constexpr float kMinM = 0.5F, kMaxM = 5.0F;
constexpr float kTargetTone = 0.50F;

float bilinear(const Image<float>& image, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(image.width - 1) - 0.001F);
  y = std::clamp(y, 0.0F, static_cast<float>(image.height - 1) - 0.001F);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const float *a = image.row(iy) + ix, *b = a + image.width;
  return (1 - fy) * (a[0] + fx * (a[1] - a[0])) + fy * (b[0] + fx * (b[1] - b[0]));
}

/// Of the whole depth sensor, steps included: what a user of the data should assume.
DepthNoise expected_noise() {
  // A step of d px in disparity is d z^2 / (f b) in depth; rounding to it adds a uniform error.
  const double step_per_m = kDisparityStepPx / (kFocalPx * kBaselineM);
  return {0.0005, std::hypot(kNoisePerM, step_per_m / std::sqrt(12.0))};
}

void measure_exactly(const Rendering& rendering, Image<std::uint16_t>* depth) {
  for (std::size_t i = 0; i < depth->pixels.size(); ++i) {
    const double raw = std::round(rendering.depth_m.pixels[i] / kDepthUnitM);
    depth->pixels[i] = raw < 65535.0 ? static_cast<std::uint16_t>(raw) : std::uint16_t{0};
  }
}

}  // namespace

RgbdCamera simulated_camera() {
  RgbdCamera camera;
  camera.name = "camloc-sim";
  camera.color = camera.depth = {640, 480, 525.0, 525.0, 319.5, 239.5};
  camera.depth_unit_m = kDepthUnitM;
  camera.min_depth_m = 0.4;
  camera.max_depth_m = 5.5;
  camera.depth_noise = expected_noise();
  return camera;
}

std::vector<Exposure> auto_expose(const std::vector<float>& mean_tones, double interval_s) {
  constexpr double kReaction_s = 0.35;
  const float share = static_cast<float>(1.0 - std::exp(-interval_s / kReaction_s));
  std::vector<Exposure> result;
  float log_gain = 0;
  for (std::size_t i = 0; i < mean_tones.size(); ++i) {
    const float wanted = 2.0F * std::log(kTargetTone / std::max(mean_tones[i], 0.02F));
    log_gain = i == 0 ? wanted : log_gain + share * (wanted - log_gain);
    const float gain = std::exp(std::clamp(log_gain, -3.0F, 3.0F));
    result.push_back({gain, std::clamp(0.009F * gain, 0.003F, 0.020F)});
  }
  return result;
}

ColorSensor::ColorSensor(const Intrinsics& intrinsics) : intrinsics_(intrinsics) {
  for (Image<float>* image : {&vignette_, &radiance_, &scratch_}) image->resize(intrinsics.width, intrinsics.height);
  const double corner_squared = intrinsics.cx * intrinsics.cx + intrinsics.cy * intrinsics.cy;
  for (int y = 0; y < intrinsics.height; ++y) {
    for (int x = 0; x < intrinsics.width; ++x) {
      const double dx = x - intrinsics.cx, dy = y - intrinsics.cy;
      vignette_.at(x, y) = static_cast<float>(1.0 - 0.35 * (dx * dx + dy * dy) / corner_squared);
    }
  }
}

void ColorSensor::blur_motion(const Rendering& rendering, const Trajectory::Twist& twist, float time_s) {
  const float f = static_cast<float>(intrinsics_.fx);
  const Eigen::Vector3f v = twist.linear.cast<float>() * time_s, w = twist.angular.cast<float>() * time_s;
  for (int y = 0; y < intrinsics_.height; ++y) {
    const float ry = (static_cast<float>(y) - static_cast<float>(intrinsics_.cy)) / f;
    for (int x = 0; x < intrinsics_.width; ++x) {
      const float rx = (static_cast<float>(x) - static_cast<float>(intrinsics_.cx)) / f;
      const float depth = rendering.depth_m.at(x, y);
      const float inverse = depth > 0.0F ? 1.0F / depth : 0.0F;
      // Motion of the scene point in the camera, divided by its depth: -v / z - w x (rx, ry, 1).
      const float px = -v.x() * inverse - (w.y() - w.z() * ry), py = -v.y() * inverse - (w.z() * rx - w.x()),
                  pz = -v.z() * inverse - (w.x() * ry - w.y() * rx);
      const float flow_x = f * (px - rx * pz), flow_y = f * (py - ry * pz);
      const float length = std::max(std::fabs(flow_x), std::fabs(flow_y));
      if (length < 0.5F) {
        radiance_.at(x, y) = rendering.radiance.at(x, y);
        continue;
      }
      const int count = std::min(2 + static_cast<int>(0.7F * length), 16);
      float sum = 0;
      for (int k = 0; k < count; ++k) {
        const float along = (static_cast<float>(k) + 0.5F) / static_cast<float>(count) - 0.5F;
        sum += bilinear(rendering.radiance, static_cast<float>(x) + along * flow_x, static_cast<float>(y) + along * flow_y);
      }
      radiance_.at(x, y) = sum / static_cast<float>(count);
    }
  }
}

void ColorSensor::soften() {
  constexpr float kSide = 0.11F;  // three-tap lens blur of about half a pixel
  const int width = intrinsics_.width, height = intrinsics_.height;
  for (int y = 0; y < height; ++y) {
    const float* in = radiance_.row(y);
    float* out = scratch_.row(y);
    out[0] = in[0];
    out[width - 1] = in[width - 1];
    for (int x = 1; x + 1 < width; ++x) out[x] = (1 - 2 * kSide) * in[x] + kSide * (in[x - 1] + in[x + 1]);
  }
  for (int y = 0; y < height; ++y) {
    const float *in = scratch_.row(y), *above = scratch_.row(std::max(0, y - 1)), *below = scratch_.row(std::min(height - 1, y + 1));
    float* out = radiance_.row(y);
    for (int x = 0; x < width; ++x) out[x] = (1 - 2 * kSide) * in[x] + kSide * (above[x] + below[x]);
  }
}

void ColorSensor::expose(const Rendering& rendering, const Trajectory::Twist& twist, const Exposure& exposure, std::uint32_t frame_seed,
                         bool is_perfect, Image<std::uint8_t>* gray) {
  gray->resize(intrinsics_.width, intrinsics_.height);
  if (is_perfect) {
    radiance_.pixels = rendering.radiance.pixels;
  } else {
    blur_motion(rendering, twist, exposure.time_s);
    soften();
  }
  // Light that the shutter did not collect is made up by amplification, and noise with it.
  const float amplification = exposure.gain * 0.009F / exposure.time_s;
  const float sigma = is_perfect ? 0.0F : std::min(6.0F, 0.9F + 0.9F * amplification);
  Xorshift random(hash32(frame_seed, 1));
  for (int y = 0; y < intrinsics_.height; ++y) {
    const float *in = radiance_.row(y), *vignette = vignette_.row(y);
    std::uint8_t* out = gray->row(y);
    for (int x = 0; x < intrinsics_.width; ++x) {
      const float light = in[x] * exposure.gain * (is_perfect ? 1.0F : vignette[x]);
      const float level = 255.0F * std::sqrt(std::max(light, 0.0F)) + sigma * normal_(random());
      out[x] = static_cast<std::uint8_t>(std::clamp(level + 0.5F, 0.0F, 255.0F));
    }
  }
}

void DepthSensor::mark_shadows(const Rendering& rendering, int y) {
  // The projector sits to the right: a point at disparity d appears to it at column x - d (scaled to colour pixels). A point
  // whose column is already passed by something nearer, further right in the image, lies in its shadow.
  const int width = intrinsics_.width;
  is_shadowed_.assign(static_cast<std::size_t>(width), 0);
  const float scale = static_cast<float>(intrinsics_.fx * kBaselineM);
  float leftmost = 1e9F;
  for (int x = width - 1; x >= 0; --x) {
    const float z = rendering.depth_m.at(x, y);
    const float column = static_cast<float>(x) - (z > 0.0F ? scale / z : 0.0F);
    if (column > leftmost + 0.5F) is_shadowed_[static_cast<std::size_t>(x)] = 1;
    leftmost = std::min(leftmost, column);
  }
}

void DepthSensor::measure(const Rendering& rendering, const Renderer& renderer, std::uint32_t frame_seed, Image<std::uint16_t>* depth) {
  depth->resize(intrinsics_.width, intrinsics_.height);
  if (is_perfect_) return measure_exactly(rendering, depth);
  const int width = intrinsics_.width, height = intrinsics_.height;
  const float focal_baseline = static_cast<float>(kFocalPx * kBaselineM);
  const float sigma_px = static_cast<float>(kNoisePerM) * focal_baseline;
  const float step = static_cast<float>(kDisparityStepPx);
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
      if (z < kMinM || z > kMaxM) continue;
      if (is_shadowed_[static_cast<std::size_t>(x)] != 0U) continue;
      if (is_edge && std::fabs(rendering.depth_m.at(from_x, from_y) - rendering.depth_m.at(x, y)) > 0.02F * z && (bits >> 16) % 4U == 0U)
        continue;
      // Little light comes back at a grazing angle, and from far away; shiny things answer in patches.
      const float cosine = rendering.cosine.at(x, y);
      const bool is_unfriendly = is_emissive(renderer.seen_surface(rendering.surface.at(x, y)).skin.material);
      if (is_unfriendly || cosine < 0.18F + 0.02F * z) {
        const float patch = value_noise(static_cast<float>(x) * 0.15F, static_cast<float>(y) * 0.15F, frame_seed);
        if (cosine < 0.10F + 0.08F * patch + 0.02F * z || (is_unfriendly && patch > -0.35F)) continue;
      }
      const float disparity = focal_baseline / z + sigma_px * normal_(more_bits);
      const float stepped = step * std::floor(disparity / step + 0.5F);
      const float measured = focal_baseline / std::max(stepped, step);
      const float raw = measured / static_cast<float>(kDepthUnitM);
      if (raw < 65534.0F) out = static_cast<std::uint16_t>(raw + 0.5F);
    }
  }
}

}  // namespace camloc::sim
