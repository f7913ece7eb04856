// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/orb_descriptor.h"

#include <array>
#include <cfloat>
#include <cmath>
#include <numbers>

#include "core/features/orb_pattern.h"

namespace camloc {
namespace {

constexpr int kRadius = 15;

/// Half width of each row of the disc, symmetric about the diagonal. Row v of a circle of radius 15, made so that (u, v)
/// is inside exactly when (v, u) is.
constexpr std::array<int, kRadius + 1> kHalfWidth = {15, 15, 15, 15, 14, 14, 14, 13, 13, 12, 11, 10, 9, 8, 6, 3};

float degrees_to_radians(float angle_deg) { return angle_deg * static_cast<float>(std::numbers::pi / 180.0); }

}  // namespace

float fast_atan2_deg(float y, float x) {
  constexpr auto kDegrees = static_cast<float>(180 / std::numbers::pi);
  constexpr float p1 = 0.9997878412794807F * kDegrees, p3 = -0.3258083974640975F * kDegrees;
  constexpr float p5 = 0.1555786518463281F * kDegrees, p7 = -0.04432655554792128F * kDegrees;
  constexpr auto kEpsilon = static_cast<float>(DBL_EPSILON);
  const float ax = std::abs(x), ay = std::abs(y);
  float angle = 0;
  if (ax >= ay) {
    const float c = ay / (ax + kEpsilon), c2 = c * c;
    angle = (((p7 * c2 + p5) * c2 + p3) * c2 + p1) * c;
  } else {
    const float c = ax / (ay + kEpsilon), c2 = c * c;
    angle = 90.F - (((p7 * c2 + p5) * c2 + p3) * c2 + p1) * c;
  }
  if (x < 0) angle = 180.F - angle;
  if (y < 0) angle = 360.F - angle;
  return angle;
}

float orb_orientation_deg(const std::uint8_t* centre, std::ptrdiff_t stride) {
  int moment_x = 0, moment_y = 0;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const std::uint8_t* row = centre + v * stride;
    const int half_width = kHalfWidth[static_cast<std::size_t>(std::abs(v))];
    int sum = 0;
    for (int u = -half_width; u <= half_width; ++u) {
      sum += row[u];
      moment_x += u * row[u];
    }
    moment_y += v * sum;
  }
  return fast_atan2_deg(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

Descriptor orb_descriptor(const std::uint8_t* centre, std::ptrdiff_t stride, float angle_deg) {
  const float angle_rad = degrees_to_radians(angle_deg);
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  // Coordinates are rounded half to even.
  const auto value = [&](int x, int y) {
    const auto xf = static_cast<float>(x), yf = static_cast<float>(y);
    return centre[std::lrint(xf * s + yf * c) * stride + std::lrint(xf * c - yf * s)];
  };
  Descriptor descriptor;
  for (std::size_t i = 0; i < kOrbPattern.size(); ++i) {
    const OrbTest& test = kOrbPattern[i];
    const std::uint64_t bit = value(test.x0, test.y0) < value(test.x1, test.y1) ? 1 : 0;
    descriptor.bits[i / 64] |= bit << (i % 64);
  }
  return descriptor;
}

}  // namespace camloc
