// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hashes and value noise, the only source of randomness in the simulator: every number is a function of a seed and a
// place, so a scene has the same bytes whatever the order in which its parts are drawn. All inline: they are the inner
// loop of the renderer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace camloc::sim {

inline std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}
inline std::uint32_t hash32(std::uint32_t a, std::uint32_t b) { return hash32(a * 0x9e3779b1U + hash32(b)); }
inline std::uint32_t hash32(std::uint32_t a, std::uint32_t b, std::uint32_t c) { return hash32(hash32(a, b), c); }
/// Of a lattice cell.
inline std::uint32_t hash_cell(int x, int y, std::uint32_t seed) {
  std::uint32_t h = seed + static_cast<std::uint32_t>(x) * 0x27d4eb2dU + static_cast<std::uint32_t>(y) * 0x165667b1U;
  h ^= h >> 15;
  h *= 0x85ebca77U;
  h ^= h >> 13;
  h *= 0xc2b2ae3dU;
  return h ^ (h >> 16);
}
/// [0, 1).
inline float unit(std::uint32_t h) { return static_cast<float>(h >> 8) * (1.0F / 16777216.0F); }
inline float range(std::uint32_t h, float low, float high) { return low + (high - low) * unit(h); }

/// floor() for values that fit an int; the library call is slow without SSE4.1.
inline int floor_int(float x) {
  const int i = static_cast<int>(x);
  return i - (x < static_cast<float>(i) ? 1 : 0);
}

/// A knot of value noise, [0, 1): a short hash, because a frame needs some ten million of them.
inline float knot(std::uint32_t column, std::uint32_t row) {
  std::uint32_t h = (column ^ row) * 0x85ebca77U;
  h ^= h >> 15;
  return unit(h * 0xc2b2ae3dU);
}

/// Smooth noise with one knot per unit square, in [-1, 1], mean 0.
inline float value_noise(float x, float y, std::uint32_t seed) {
  constexpr std::uint32_t kColumn = 0x27d4eb2dU, kRow = 0x165667b1U;
  const int ix = floor_int(x), iy = floor_int(y);
  const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
  const std::uint32_t column = static_cast<std::uint32_t>(ix) * kColumn, row = static_cast<std::uint32_t>(iy) * kRow + seed * 0x9e3779b1U;
  const float a = knot(column, row), b = knot(column + kColumn, row);
  const float c = knot(column, row + kRow), d = knot(column + kColumn, row + kRow);
  const float sx = fx * fx * (3.0F - 2.0F * fx), sy = fy * fy * (3.0F - 2.0F * fy);
  const float low = a + (b - a) * sx, high = c + (d - c) * sx;
  return 2.0F * (low + (high - low) * sy) - 1.0F;
}

/// Weight of a pattern with period `scale_m` seen with pixels of `foot_m`: 1 when well resolved, 0 when finer than two pixels.
inline float resolved(float scale_m, float foot_m) {
  const float w = (scale_m / foot_m - 2.0F) * 0.5F;
  return w < 0.0F ? 0.0F : (w > 1.0F ? 1.0F : w);
}

/// Sum of octaves of value noise, the coarsest with knots every `scale_m`, each next one half the scale and `gain` the
/// amplitude; octaves finer than the pixel are left out. About [-1, 1] for gain 0.5.
inline float octaves(float u, float v, float scale_m, int num_octaves, float gain, std::uint32_t seed, float foot_m) {
  float sum = 0, amplitude = 1, norm = 0;
  for (int k = 0; k < num_octaves; ++k) {
    norm += amplitude;
    const float weight = resolved(scale_m, foot_m);
    if (weight > 0.0F)
      sum += weight * amplitude * value_noise(u / scale_m, v / scale_m, seed + static_cast<std::uint32_t>(k) * 0x68bc21ebU);
    scale_m *= 0.5F;
    amplitude *= gain;
  }
  return 1.5F * sum / norm;
}

/// Fast reproducible Gaussian noise: quantiles of the normal distribution.
class NormalTable {
 public:
  NormalTable() {
    for (std::size_t i = 0; i < kSize; ++i) values_[i] = static_cast<float>(quantile((static_cast<double>(i) + 0.5) / kSize));
  }
  /// Standard normal from any well mixed bits.
  [[nodiscard]] float operator()(std::uint32_t bits) const { return values_[bits >> (32 - kBits)]; }

 private:
  static constexpr int kBits = 12;
  static constexpr std::size_t kSize = 1U << kBits;

  /// Inverse of the normal distribution by bisection of erfc; only run 4096 times.
  static double quantile(double p) {
    double low = -6, high = 6;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  std::array<float, kSize> values_{};
};

/// Marsaglia, "Xorshift RNGs", 2003.
class Xorshift {
 public:
  explicit Xorshift(std::uint32_t seed) : state_(hash32(seed) | 1U) {}
  std::uint32_t operator()() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }

 private:
  std::uint32_t state_;
};

// Building blocks of textures: shapes and lattices whose edges are filtered to the pixel. Coverages are in [0, 1].

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
