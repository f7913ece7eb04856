// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Fast reproducible Gaussian noise: quantiles of the normal distribution, drawn by a small generator.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {

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

}  // namespace camloc::sim
