// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/mapping/cloud/cloud_index.h"

namespace camloc::mapping {
namespace {

constexpr int kBorder = 1;  // cells beside the outermost ones

struct Scored {
  std::uint16_t score;
  Eigen::Array3i cell;
};

}  // namespace

CellGrid::CellGrid(const std::vector<Eigen::Vector3d>& points_m, double cell_m, std::size_t max_cells) : cell_m_(cell_m) {
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  if (!points_m.empty()) low_m_ = high = points_m.front();
  for (const Eigen::Vector3d& p : points_m) low_m_ = low_m_.cwiseMin(p), high = high.cwiseMax(p);
  const auto cells_at = [&](double edge_m) { return (((high - low_m_) / edge_m).array().floor() + 1 + 2 * kBorder).eval(); };
  while (cells_at(cell_m_).prod() > static_cast<double>(max_cells)) cell_m_ *= 1.25;
  size_ = cells_at(cell_m_).cast<int>();
  low_m_.array() -= kBorder * cell_m_;
  cells_.assign(size_.cast<std::size_t>().prod(), 0);
  const auto at = [&](const Eigen::Vector3i& cell) -> std::uint8_t& {
    const auto c = cell.cast<std::size_t>().eval(), size = size_.matrix().cast<std::size_t>().eval();
    return cells_[(c.z() * size.y() + c.y()) * size.x() + c.x()];
  };
  for (const Eigen::Vector3d& p : points_m) {
    const Eigen::Vector3i cell = ((p - low_m_) / cell_m_).array().floor().cast<int>();
    at(cell) = 2;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        std::uint8_t& value = at(cell + side * Eigen::Vector3i::Unit(axis));
        value = std::max<std::uint8_t>(value, 1);
      }
    }
  }
}

void CellGrid::score_row(const std::vector<Eigen::Array3i>& points, int ty, int tz, int first_x, std::vector<std::uint16_t>* scores) const {
  std::fill(scores->begin(), scores->end(), std::uint16_t{0});
  const int num_x = static_cast<int>(scores->size());
  for (const auto& point : points) {
    const int y = point[1] + ty, z = point[2] + tz;
    if (y < 0 || z < 0 || y >= size_[1] || z >= size_[2]) continue;
    // tx = first_x + i reads cell point[0] + tx of the row; both ends are clipped once, so that the loop has no test.
    const int offset = point[0] + first_x, begin = std::max(0, -offset), end = std::min(num_x, size_[0] - offset);
    const std::uint8_t* row = cells_.data() + (static_cast<std::ptrdiff_t>(z) * size_[1] + y) * size_[0];
    std::uint16_t* out = scores->data();
    for (int i = begin; i < end; ++i) out[i] = static_cast<std::uint16_t>(out[i] + row[offset + i]);
  }
}

std::vector<CellGrid::Place> CellGrid::best_places(const std::vector<Eigen::Vector3d>& points_m, std::size_t max_places) const {
  if (points_m.empty() || points_m.size() > 30000) return {};  // two a point fit 16 bits
  Eigen::Vector3d low = points_m.front(), high = low;
  for (const Eigen::Vector3d& p : points_m) low = low.cwiseMin(p), high = high.cwiseMax(p);
  std::vector<Eigen::Array3i> points;
  Eigen::Array3i extent = Eigen::Array3i::Zero();
  for (const Eigen::Vector3d& p : points_m) {
    points.push_back(((p - low) / cell_m_).array().floor().cast<int>());
    extent = extent.max(points.back() + 1);
  }
  const Eigen::Array3i first = -extent / 2, last = size_ - extent + extent / 2;
  std::vector<std::uint16_t> scores(static_cast<std::size_t>(std::max(0, last[0] - first[0] + 1)));
  std::vector<Scored> best;
  for (int tz = first[2]; tz <= last[2]; ++tz) {
    for (int ty = first[1]; ty <= last[1]; ++ty) {
      score_row(points, ty, tz, first[0], &scores);
      const auto top = std::max_element(scores.begin(), scores.end());  // one a row is enough: neighbouring rows have the others
      if (top != scores.end()) best.push_back({*top, {first[0] + static_cast<int>(top - scores.begin()), ty, tz}});
    }
  }
  std::stable_sort(best.begin(), best.end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<Place> places;
  std::vector<Eigen::Array3i> taken;
  for (const Scored& scored : best) {
    const auto is_near = [&](const Eigen::Array3i& other) { return (other - scored.cell).abs().maxCoeff() < 3; };
    if (std::any_of(taken.begin(), taken.end(), is_near)) continue;
    taken.push_back(scored.cell);
    places.push_back({low_m_ + cell_m_ * scored.cell.matrix().cast<double>() - low,
                      static_cast<double>(scored.score) / (2.0 * static_cast<double>(points.size()))});
    if (places.size() >= max_places) break;
  }
  return places;
}

}  // namespace camloc::mapping
