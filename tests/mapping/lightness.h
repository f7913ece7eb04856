// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How light a colour looks, for tests of what can be told apart in grey.
#pragma once

#include <cmath>

#include "tools/mapping/picture/point_raster.h"

namespace camloc::mapping {

/// CIE lightness L* of a screen colour, 0 (black) to 100 (white).
inline double lightness_of(Rgb color) {
  const auto to_linear_light = [](double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); };
  const double y =
      0.2126 * to_linear_light(color[0] / 255.0) + 0.7152 * to_linear_light(color[1] / 255.0) + 0.0722 * to_linear_light(color[2] / 255.0);
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

}  // namespace camloc::mapping
