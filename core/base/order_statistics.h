// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Values by rank, without interpolation. They take their own copy, because finding a rank reorders.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
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

/// The smallest and largest without one part in `parts` at each end: {1st, 99th percentile} for 100. Zeros for none.
template <typename T>
[[nodiscard]] std::pair<T, T> trimmed_range(std::vector<T> values, std::size_t parts) {
  if (values.empty()) return {};
  const auto tail = static_cast<std::ptrdiff_t>(values.size() / parts);
  const auto low = values.begin() + tail, high = values.end() - 1 - tail;
  std::nth_element(values.begin(), low, values.end());
  const T lowest = *low;
  std::nth_element(values.begin(), high, values.end());
  return {lowest, *high};
}

}  // namespace camloc
