// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hashes and value noise, the only source of randomness in the simulator: every number is a function of a seed and a
// place, so a scene has the same bytes whatever the order in which its parts are drawn. All inline: they are the inner
// loop of the renderer.
#pragma once

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

}  // namespace camloc::sim
