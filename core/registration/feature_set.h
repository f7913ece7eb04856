// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which features of one frame a pose explains, as bits: two poses that explain the same ones cannot be told apart by them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace camloc {

class FeatureSet {
 public:
  /// Features beyond this many are left out.
  static constexpr std::size_t kCapacity = 4096;

  void clear() { words_.fill(0); }
  void add(std::size_t feature) {
    if (feature < kCapacity) words_[feature / 64] |= std::uint64_t{1} << (feature % 64);
  }
  /// How many are in here and not in `other`.
  [[nodiscard]] std::size_t count_without(const FeatureSet& other) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < words_.size(); ++i) count += static_cast<std::size_t>(std::popcount(words_[i] & ~other.words_[i]));
    return count;
  }

 private:
  std::array<std::uint64_t, kCapacity / 64> words_{};
};

}  // namespace camloc
