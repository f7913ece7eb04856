// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/matcher.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <limits>

#include "core/features/hamming_kernels.h"

namespace camloc {
namespace {

constexpr std::uint16_t kNoDistance = 257;

/// Bucket coordinate of a pixel, clamped to the grid; NaN goes to 0.
int clamped_cell(float pixel, int cell_px, int num_cells) {
  const float cell = pixel / static_cast<float>(cell_px);
  if (!(cell > 0)) return 0;
  return cell < static_cast<float>(num_cells) ? static_cast<int>(cell) : num_cells - 1;
}

}  // namespace

FeatureGrid::FeatureGrid(int width, int height, int max_features, int cell_px)
    : columns_(std::max(1, (width + cell_px - 1) / cell_px)),
      rows_(std::max(1, (height + cell_px - 1) / cell_px)),
      cell_px_(cell_px),
      max_features_(max_features),
      bucket_begin_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1),
      feature_(static_cast<std::size_t>(max_features)) {
  assert(cell_px > 0);
}

int FeatureGrid::bucket_of(const Keypoint& keypoint) const {
  return clamped_cell(keypoint.v, cell_px_, rows_) * columns_ + clamped_cell(keypoint.u, cell_px_, columns_);
}

void FeatureGrid::assign(std::span<const Keypoint> keypoints) {
  const std::size_t count = std::min(keypoints.size(), feature_.size());
  // Counting sort, filled from the back so that features stay in order within a bucket.
  std::fill(bucket_begin_.begin(), bucket_begin_.end(), 0);
  for (std::size_t i = 0; i < count; ++i) ++bucket_begin_[static_cast<std::size_t>(bucket_of(keypoints[i]))];
  std::int32_t end = 0;
  for (auto& bucket : bucket_begin_) bucket = end += bucket;
  for (std::size_t i = count; i-- > 0;) {
    auto& begin = bucket_begin_[static_cast<std::size_t>(bucket_of(keypoints[i]))];
    feature_[static_cast<std::size_t>(--begin)] = static_cast<std::int32_t>(i);
  }
}

std::span<const std::int32_t> FeatureGrid::buckets(int first_column, int last_column, int row) const {
  assert(first_column >= 0 && first_column <= last_column && last_column < columns_ && row >= 0 && row < rows_);
  const std::int32_t begin = bucket_begin_[static_cast<std::size_t>(row * columns_ + first_column)];
  const std::int32_t end = bucket_begin_[static_cast<std::size_t>(row * columns_ + last_column) + 1];
  return {feature_.data() + begin, static_cast<std::size_t>(end - begin)};
}

void GuidedMatcher::FeatureTable::assign(const Features& from, const FeatureGrid& grid) {
  const std::span<const std::int32_t> order = grid.all();
  size = std::min(order.size(), features.size());
  for (std::size_t position = 0; position < size; ++position) {
    features[position] = order[position];
    const auto index = static_cast<std::size_t>(order[position]);
    if (index >= from.size()) {
      u[position] = std::numeric_limits<float>::quiet_NaN();  // the grid is of another frame: in no window
      continue;
    }
    u[position] = from.keypoints[index].u;
    v[position] = from.keypoints[index].v;
    levels[position] = from.keypoints[index].level;
    descriptors[position] = from.descriptors[index];
  }
}

GuidedMatcher::GuidedMatcher(const GuidedMatcherOptions& options, int max_features)
    : options_(options),
      best_of_feature_(static_cast<std::size_t>(max_features)),
      table_(static_cast<std::size_t>(max_features)),
      window_(static_cast<std::size_t>(max_features)),
      distances_(static_cast<std::size_t>(max_features)),
      appearance_distances_(static_cast<std::size_t>(max_features)) {
  matches_.reserve(static_cast<std::size_t>(max_features));
}

void GuidedMatcher::collect_window(const FeatureGrid& grid, const ProjectedLandmark& landmark) {
  window_size_ = 0;
  const float radius = landmark.radius_px;
  if (!(landmark.u + radius >= 0) || !(landmark.v + radius >= 0) || landmark.min_level > landmark.max_level) return;
  const int first_column = clamped_cell(landmark.u - radius, grid.cell_px(), grid.columns());
  const int last_column = clamped_cell(landmark.u + radius, grid.cell_px(), grid.columns());
  const int first_row = clamped_cell(landmark.v - radius, grid.cell_px(), grid.rows());
  const int last_row = clamped_cell(landmark.v + radius, grid.cell_px(), grid.rows());
  if (last_column < first_column) return;
  const float squared_radius = radius * radius;
  const unsigned min_level = landmark.min_level, num_levels = landmark.max_level - min_level;
  const float *u = table_.u.data(), *v = table_.v.data();
  const std::uint8_t* levels = table_.levels.data();
  std::uint32_t* window = window_.data();
  std::size_t count = 0;
  for (int row = first_row; row <= last_row; ++row) {
    const std::span<const std::int32_t> stretch = grid.buckets(first_column, last_column, row);
    const auto begin = static_cast<std::size_t>(stretch.data() - grid.all().data());
    const std::size_t end = std::min(begin + stretch.size(), table_.size);
    for (std::size_t i = begin; i < end; ++i) {
      // Without a branch: which features are inside cannot be predicted.
      const float du = u[i] - landmark.u, dv = v[i] - landmark.v;
      window[count] = static_cast<std::uint32_t>(i);
      count += static_cast<std::size_t>((du * du + dv * dv <= squared_radius) & (levels[i] - min_level <= num_levels));
    }
  }
  window_size_ = count;
}

void GuidedMatcher::measure_window(std::span<const Descriptor> appearances) {
  const auto distances_at = hamming::best_kernels().distances_at;
  std::fill_n(distances_.begin(), window_size_, kNoDistance);
  for (std::size_t k = 0; k < appearances.size(); ++k) {
    std::uint16_t* const distances = k == 0 ? distances_.data() : appearance_distances_.data();
    distances_at(appearances[k], table_.descriptors.data(), window_.data(), window_size_, distances);
    if (k == 0) continue;
    for (std::size_t i = 0; i < window_size_; ++i) distances_[i] = std::min(distances_[i], appearance_distances_[i]);
  }
}

Match GuidedMatcher::best_in_window() const {
  Match match;
  const std::uint16_t distance = hamming::smallest(distances_.data(), window_size_);
  if (distance >= kNoDistance || distance > options_.max_distance) return match;  // most landmarks end here
  std::size_t best = window_size_;
  for (std::size_t i = 0; i < window_size_; ++i) {
    if (distances_[i] != distance) continue;
    // Equal distances: the first feature.
    if (best == window_size_ || table_.features[window_[i]] < table_.features[window_[best]]) best = i;
  }
  // Features of the same spot on a far level are no rivals: they describe the landmark at another scale.
  const int best_level = table_.levels[window_[best]];
  for (std::size_t i = 0; i < window_size_; ++i) {
    if (distances_[i] >= match.second || i == best) continue;  // smaller ones are rare: a branch that can be predicted
    if (std::abs(table_.levels[window_[i]] - best_level) <= 1) match.second = distances_[i];
  }
  if (options_.max_ratio < 1 && distance > options_.max_ratio * match.second) return Match{};
  match.feature = table_.features[window_[best]];
  match.distance = distance;
  return match;
}

std::span<const Match> GuidedMatcher::match(const Features& features, const FeatureGrid& grid, std::span<const ProjectedLandmark> landmarks,
                                            std::span<const Descriptor> descriptors) {
  std::fill(best_of_feature_.begin(), best_of_feature_.end(), Match{});
  table_.assign(features, grid);
  for (const ProjectedLandmark& landmark : landmarks) {
    if (landmark.first_descriptor >= descriptors.size()) continue;
    collect_window(grid, landmark);
    if (window_size_ == 0) continue;
    const std::size_t num_left = descriptors.size() - landmark.first_descriptor;
    measure_window(descriptors.subspan(landmark.first_descriptor, std::min<std::size_t>(landmark.num_descriptors, num_left)));
    Match match = best_in_window();
    if (match.feature < 0 || static_cast<std::size_t>(match.feature) >= best_of_feature_.size()) continue;
    match.landmark = landmark.landmark;
    Match& claimed = best_of_feature_[static_cast<std::size_t>(match.feature)];
    if (claimed.feature < 0 || match.distance < claimed.distance) claimed = match;
  }
  matches_.clear();
  for (const Match& match : best_of_feature_)
    if (match.feature >= 0) matches_.push_back(match);
  return matches_;
}

}  // namespace camloc
