// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pixels around a feature, on the pyramid level it was found on: enough to find out later, to a fraction of a pixel, where
// one image shows what another one shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace camloc {

struct FeaturePatch {
  static constexpr int kHalf = 8, kSide = 2 * kHalf + 1;
  std::array<std::uint8_t, static_cast<std::size_t>(kSide* kSide)> pixels{};  ///< row by row, the feature in the middle

  /// Grey level at whole pixels from the feature, each in [-kHalf, kHalf].
  [[nodiscard]] std::uint8_t at(int dx, int dy) const { return pixels[static_cast<std::size_t>((dy + kHalf) * kSide + dx + kHalf)]; }
};

}  // namespace camloc
