// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/corner_selection.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/features/orb_descriptor.h"

namespace camloc {
namespace {

constexpr int kThreshold = 20, kMinThreshold = 7;  // grey levels; the lower one for cells without a corner at the other
constexpr int kCellPx = 32;
constexpr int kMaxPerCell = 64;  // weaker corners of a cell are dropped

bool is_stronger(const Corner& a, const Corner& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

bool is_before(const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

/// Local maximum of the 3 x 3 scores around `p`; of equal neighbours the first in reading order.
bool is_maximum(const std::uint8_t* p, std::ptrdiff_t stride) {
  const std::uint8_t score = *p;
  const std::uint8_t *above = p - stride, *below = p + stride;
  // Without branches: most corners fail, at a place that cannot be predicted.
  const unsigned is_above = (score > above[-1]) & (score > above[0]) & (score > above[1]) & (score > p[-1]);
  const unsigned is_below = (score >= p[1]) & (score >= below[-1]) & (score >= below[0]) & (score >= below[1]);
  return (is_above & is_below) != 0;
}

/// Position in memory of the byte that holds the lowest bit set.
int first_byte(std::uint64_t bytes) {
  static_assert(std::endian::native == std::endian::little);
  return std::countr_zero(bytes) / 8;
}

}  // namespace

CornerSelector::CornerSelector(int max_width, int max_height, int max_corners) : fast_scores_(available_fast_kernels().back().scores) {
  scores_.allocate(max_width, max_height);
  const int columns = std::max(0, max_width - 2 * kOrbBorder + kCellPx - 1) / kCellPx;
  const int rows = std::max(0, max_height - 2 * kOrbBorder + kCellPx - 1) / kCellPx;
  const std::size_t num_cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  cells_.reserve(num_cells);
  corner_of_cell_.resize(num_cells * kMaxPerCell);
  selected_.reserve(static_cast<std::size_t>(max_corners) + num_cells);
}

std::span<const Corner> CornerSelector::select(const PaddedImage& level, int count) {
  selected_.clear();
  lay_out_cells(level);
  if (cells_.empty() || count <= 0) return selected_;
  score(level, kOrbBorder, kOrbBorder, level.width - kOrbBorder, level.height - kOrbBorder, kThreshold);
  collect(kOrbBorder, kOrbBorder, level.width - kOrbBorder, level.height - kOrbBorder);
  // All empty cells are scored before any is searched, so that the result does not depend on their order.
  for (Cell& cell : cells_) {
    cell.is_weak = cell.count == 0;
    if (cell.is_weak) score(level, cell.x0, cell.y0, cell.x1, cell.y1, kMinThreshold);
  }
  for (const Cell& cell : cells_)
    if (cell.is_weak) collect(cell.x0, cell.y0, cell.x1, cell.y1);
  for (Cell& cell : cells_) std::sort(cell.corners, cell.corners + cell.count, is_stronger);
  take_evenly(count);
  return selected_;
}

void CornerSelector::lay_out_cells(const PaddedImage& level) {
  cells_.clear();
  constexpr int border = kOrbBorder, side = kCellPx;
  if (level.width <= 2 * border || level.height <= 2 * border) return;
  Corner* corners = corner_of_cell_.data();
  columns_ = (level.width - 2 * border + side - 1) / side;
  for (int y = border; y < level.height - border; y += side)
    for (int x = border; x < level.width - border; x += side, corners += kMaxPerCell)
      cells_.push_back({x, y, std::min(x + side, level.width - border), std::min(y + side, level.height - border), corners, 0, false});
  // A frame of zero scores around the searched area.
  const auto searched_width = static_cast<std::size_t>(level.width - 2 * border + 2);
  std::memset(scores_.row(border - 1) + border - 1, 0, searched_width);
  std::memset(scores_.row(level.height - border) + border - 1, 0, searched_width);
  for (int y = border; y < level.height - border; ++y) scores_.row(y)[border - 1] = scores_.row(y)[level.width - border] = 0;
}

void CornerSelector::score(const PaddedImage& level, int x0, int y0, int x1, int y1, int threshold) {
  for (int y = y0; y < y1; ++y) fast_scores_(level.row(y) + x0, level.stride, x1 - x0, threshold, scores_.row(y) + x0);
}

void CornerSelector::collect(int x0, int y0, int x1, int y1) {
  constexpr int border = kOrbBorder, side = kCellPx;
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* row = scores_.row(y);
    Cell* cells = cells_.data() + static_cast<std::ptrdiff_t>((y - border) / side) * columns_;
    for (int x = x0; x < x1; x += 8) {
      // Most pixels are no corners: look at eight scores at once. Rows are padded.
      std::uint64_t eight;
      std::memcpy(&eight, row + x, sizeof(eight));
      if (eight == 0) continue;
      constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7f;
      for (std::uint64_t set = (((eight & kLow) + kLow) | eight) & ~kLow; set != 0; set &= set - 1) {
        const int i = x + first_byte(set);
        if (i < x1 && is_maximum(row + i, scores_.stride))
          add(&cells[(i - border) / side], {static_cast<std::int16_t>(i), static_cast<std::int16_t>(y), row[i]});
      }
    }
  }
}

void CornerSelector::add(Cell* cell, Corner corner) {
  if (cell->count < kMaxPerCell) {
    cell->corners[cell->count++] = corner;
    return;
  }
  Corner* weakest = std::max_element(cell->corners, cell->corners + kMaxPerCell, is_stronger);
  if (is_stronger(corner, *weakest)) *weakest = corner;
}

void CornerSelector::take_evenly(int count) {
  // Rank by rank: as long as all corners of a rank fit, take them; of the last rank the strongest.
  for (int rank = 0; rank < kMaxPerCell; ++rank) {
    const std::size_t begin = selected_.size();
    for (const Cell& cell : cells_)
      if (cell.count > rank) selected_.push_back(cell.corners[rank]);
    if (selected_.size() == begin) break;
    if (selected_.size() >= static_cast<std::size_t>(count)) {
      const auto first = selected_.begin() + static_cast<std::ptrdiff_t>(begin);
      std::nth_element(first, selected_.begin() + count - (selected_.size() == static_cast<std::size_t>(count) ? 1 : 0), selected_.end(),
                       is_stronger);
      selected_.resize(static_cast<std::size_t>(count));
      break;
    }
  }
  std::sort(selected_.begin(), selected_.end(), is_before);
}

}  // namespace camloc
