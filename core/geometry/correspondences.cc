// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/correspondences.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

namespace camloc {

Correspondences::Correspondences(std::size_t capacity) : feature(capacity), landmark(capacity), order_(capacity), scratch_(capacity) {
  for (std::vector<float>* values : floats()) values->resize(capacity);
}

std::array<std::vector<float>*, 8> Correspondences::floats() { return {&x, &y, &X, &Y, &Z, &depth_m, &sigma_px, &rank}; }

bool Correspondences::add(float x_normalized, float y_normalized, float x_map, float y_map, float z_map, float depth, float sigma,
                          float match_rank, std::int32_t feature_index, std::int32_t landmark_index) {
  if (size_ == capacity()) return false;
  assert(!std::isnan(match_rank));
  const std::size_t i = size_++;
  x[i] = x_normalized;
  y[i] = y_normalized;
  X[i] = x_map;
  Y[i] = y_map;
  Z[i] = z_map;
  depth_m[i] = depth;
  sigma_px[i] = sigma;
  rank[i] = match_rank;
  feature[i] = feature_index;
  landmark[i] = landmark_index;
  return true;
}

void Correspondences::sort_by_rank() {
  const auto begin = order_.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(size_);
  std::iota(begin, end, 0);
  // std::stable_sort allocates; std::sort does not, and the index as second key makes it stable.
  std::sort(begin, end, [this](std::int32_t a, std::int32_t b) {
    const float rank_a = rank[static_cast<std::size_t>(a)], rank_b = rank[static_cast<std::size_t>(b)];
    return rank_a < rank_b || (rank_a == rank_b && a < b);
  });
  const auto reorder = [this]<typename T>(std::vector<T>& values) {
    for (std::size_t i = 0; i < size_; ++i) scratch_[i] = std::bit_cast<float>(values[static_cast<std::size_t>(order_[i])]);
    for (std::size_t i = 0; i < size_; ++i) values[i] = std::bit_cast<T>(scratch_[i]);
  };
  for (std::vector<float>* values : floats()) reorder(*values);
  for (std::vector<std::int32_t>* values : {&feature, &landmark}) reorder(*values);
}

}  // namespace camloc
