// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Values by rank, without interpolation. Both take their own copy, because finding a rank reorders.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace camloc {

/// The middle one, of an even number the upper of the two; 0 for none.
template <typename T>
[[nodiscard]] T upper_median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The value of rank floor(fraction (n - 1)), counted from the smallest; 0 for none.
template <typename T>
[[nodiscard]] T lower_quantile(std::vector<T> values, double fraction) {
  if (values.empty()) return T{};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace camloc
