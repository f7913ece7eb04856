// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A smooth texture that can be asked at any place: generated truth for what compares pixels.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace camloc::testing {

/// A sum of waves in all directions, 5 to 16 units long; about +-60 grey levels.
class Texture {
 public:
  explicit Texture(std::uint64_t seed) {
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (Wave& wave : waves_) {
      const double angle = 2 * std::numbers::pi * uniform(rng), length = 5 + 11 * uniform(rng);
      wave.along = 2 * std::numbers::pi / length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      wave.phase = 2 * std::numbers::pi * uniform(rng);
    }
  }

  [[nodiscard]] double at(const Eigen::Vector2d& place) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.along.dot(place) + wave.phase);
    return 18 * sum;
  }

 private:
  struct Wave {
    Eigen::Vector2d along;
    double phase = 0;
  };
  std::array<Wave, 8> waves_;
};

}  // namespace camloc::testing
