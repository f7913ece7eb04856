// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Building blocks of textures: shapes and lattices whose edges are filtered to the pixel. Coverages are in [0, 1].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {

inline float mix(float a, float b, float t) { return a + (b - a) * t; }
inline float clamp01(float x) { return std::clamp(x, 0.0F, 1.0F); }

/// Share of the pixel [x - foot/2, x + foot/2] inside [low, high].
inline float covered(float x, float low, float high, float foot) {
  return clamp01((std::min(x + 0.5F * foot, high) - std::max(x - 0.5F * foot, low)) / foot);
}
inline float covered_rectangle(float u, float v, float u0, float v0, float u1, float v1, float foot) {
  return covered(u, u0, u1, foot) * covered(v, v0, v1, foot);
}
inline float covered_disc(float u, float v, float cu, float cv, float radius, float foot) {
  const float distance = std::sqrt((u - cu) * (u - cu) + (v - cv) * (v - cv));
  return clamp01(0.5F + (radius - distance) / foot);
}
/// Lines of `width` every `period`, the first centred at 0.
inline float covered_lines(float x, float period, float width, float foot) {
  if (foot > 0.5F * period) return width / period;
  const float k = static_cast<float>(floor_int(x / period + 0.5F));
  return covered(x - k * period, -0.5F * width, 0.5F * width, foot);
}

/// A lattice of square cells with values cell(i, j), box-filtered: exact for pixels up to one cell, `mean` far beyond.
template <typename Cell>
float filtered_lattice(float x, float y, float foot, float mean, Cell cell) {
  if (foot >= 2.0F) return mean;
  const float f = std::min(foot, 1.0F);
  const int i = floor_int(x - 0.5F * f), j = floor_int(y - 0.5F * f);
  // Weight of the next cell: how far the pixel reaches over the border.
  const float wx = clamp01((x + 0.5F * f - static_cast<float>(i + 1)) / f);
  const float wy = clamp01((y + 0.5F * f - static_cast<float>(j + 1)) / f);
  float value = 0;
  if (wx < 1.0F && wy < 1.0F) value += (1 - wx) * (1 - wy) * cell(i, j);
  if (wx > 0.0F && wy < 1.0F) value += wx * (1 - wy) * cell(i + 1, j);
  if (wx < 1.0F && wy > 0.0F) value += (1 - wx) * wy * cell(i, j + 1);
  if (wx > 0.0F && wy > 0.0F) value += wx * wy * cell(i + 1, j + 1);
  return foot <= 1.0F ? value : mix(value, mean, foot - 1.0F);
}

/// Ink of text in an invented alphabet: glyphs of 4 x 6 dots in cells of 5 x 8 dots, words with gaps between them.
inline float text_ink(float u, float v, float line_height, std::uint32_t seed, float foot) {
  const float dot = line_height / 8.0F;
  return filtered_lattice(u / dot, v / dot, foot / dot, 0.22F, [seed](int i, int j) {
    const int column = floor_int(static_cast<float>(i) / 5.0F), line = floor_int(static_cast<float>(j) / 8.0F);
    const int x = i - column * 5, y = j - line * 8;
    if (x == 4 || y >= 6) return 0.0F;
    const std::uint32_t glyph = hash_cell(column, line, seed);
    if (glyph % 6U == 0U) return 0.0F;
    // One of 40 letters, so that the same letters come back as in real text; at least a stem to keep them solid.
    const std::uint32_t letter = hash32(glyph % 40U + 17U);
    const bool stem = x == static_cast<int>(letter >> 30);
    return stem || ((letter >> (x + 4 * y)) & 1U) != 0U ? 1.0F : 0.0F;
  });
}

}  // namespace camloc::sim
