// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pairs of an image feature and a landmark, as structure of arrays so that scoring runs over plain floats. Capacity is
// fixed at construction; adding beyond it is refused.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace camloc {

struct Correspondences {
  explicit Correspondences(std::size_t capacity = 0);

  /// Image coordinates are normalized and undistorted; the point is in `map`, metres. Returns false when full.
  bool add(float x_normalized, float y_normalized, float x_map, float y_map, float z_map, float depth_m, float sigma_px, float rank,
           std::int32_t feature, std::int32_t landmark);
  void clear() { size_ = 0; }
  /// Forgets all pairs beyond the first `count`.
  void truncate(std::size_t count) { size_ = count < size_ ? count : size_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return x.size(); }
  /// Orders all pairs by rank, best (smallest) first; stable, without allocation.
  void sort_by_rank();

  std::vector<float> x, y;                      ///< normalized image coordinates
  std::vector<float> X, Y, Z;                   ///< landmark in `map`, metres
  std::vector<float> depth_m;                   ///< measured depth along the optical axis, 0 = none
  std::vector<float> sigma_px;                  ///< standard deviation of the feature position, pixels of level 0
  std::vector<float> rank;                      ///< match quality, smaller is better (descriptor distance)
  std::vector<std::int32_t> feature, landmark;  ///< indices of the caller

 private:
  [[nodiscard]] std::array<std::vector<float>*, 8> floats();

  std::size_t size_ = 0;
  std::vector<std::int32_t> order_;
  std::vector<float> scratch_;
};

}  // namespace camloc
