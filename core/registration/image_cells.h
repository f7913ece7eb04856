// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How much of an image is covered: 8 x 6 cells, and the share of them that hold a point. Pixel centres are at integers, so the image
// reaches from -0.5 to width - 0.5.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace camloc {

class ImageCells {
 public:
  ImageCells(int width, int height)
      : columns_per_px_(static_cast<float>(kColumns) / static_cast<float>(width)),
        rows_per_px_(static_cast<float>(kRows) / static_cast<float>(height)) {}
  void clear() { occupied_ = 0; }
  /// Points outside the image count for the nearest cell.
  void add(float u, float v) {
    const int column = std::clamp(static_cast<int>((u + 0.5F) * columns_per_px_), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>((v + 0.5F) * rows_per_px_), 0, kRows - 1);
    occupied_ |= std::uint64_t{1} << (row * kColumns + column);
  }
  [[nodiscard]] double share() const { return static_cast<double>(std::popcount(occupied_)) / (kColumns * kRows); }

 private:
  static constexpr int kColumns = 8, kRows = 6;
  float columns_per_px_, rows_per_px_;
  std::uint64_t occupied_ = 0;
};

}  // namespace camloc
