// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Buckets of features, and matching guided by a predicted pose.
#include "core/features/matcher.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

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

std::span<const std::int32_t> FeatureGrid::bucket(int column, int row) const {
  assert(column >= 0 && column < columns_ && row >= 0 && row < rows_);
  const auto index = static_cast<std::size_t>(row * columns_ + column);
  return {feature_.data() + bucket_begin_[index], static_cast<std::size_t>(bucket_begin_[index + 1] - bucket_begin_[index])};
}

GuidedMatcher::GuidedMatcher(const GuidedMatcherOptions& options, int max_features)
    : options_(options), best_of_feature_(static_cast<std::size_t>(max_features)) {
  matches_.reserve(static_cast<std::size_t>(std::max(0, options.max_matches)));
  window_.reserve(static_cast<std::size_t>(max_features));
}

void GuidedMatcher::collect_window(const Features& features, const FeatureGrid& grid, const ProjectedLandmark& landmark,
                                   std::span<const Descriptor> descriptors) {
  window_.clear();
  const float radius = landmark.radius_px;
  if (!(landmark.u + radius >= 0) || !(landmark.v + radius >= 0) || landmark.first_descriptor >= descriptors.size()) return;
  const std::span<const Descriptor> appearances = descriptors.subspan(
      landmark.first_descriptor,
      std::min<std::size_t>(landmark.num_descriptors, descriptors.size() - landmark.first_descriptor));
  const auto distance = hamming::best_kernels().distance;
  const int first_column = clamped_cell(landmark.u - radius, grid.cell_px(), grid.columns());
  const int last_column = clamped_cell(landmark.u + radius, grid.cell_px(), grid.columns());
  const int first_row = clamped_cell(landmark.v - radius, grid.cell_px(), grid.rows());
  const int last_row = clamped_cell(landmark.v + radius, grid.cell_px(), grid.rows());
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first_column; column <= last_column; ++column)
      for (const std::int32_t feature : grid.bucket(column, row)) {
        const auto index = static_cast<std::size_t>(feature);
        if (index >= features.size() || window_.size() == window_.capacity()) break;
        const Keypoint& keypoint = features.keypoints[index];
        const float du = keypoint.u - landmark.u, dv = keypoint.v - landmark.v;
        if (!(du * du + dv * dv <= radius * radius)) continue;
        if (keypoint.level < landmark.min_level || keypoint.level > landmark.max_level) continue;
        int smallest = kNoDistance;
        for (const Descriptor& appearance : appearances)
          smallest = std::min(smallest, distance(appearance, features.descriptors[index]));
        window_.push_back({feature, keypoint.level, static_cast<std::uint16_t>(smallest)});
      }
}

Match GuidedMatcher::best_in_window() const {
  const auto best = std::min_element(window_.begin(), window_.end(), [](const WindowFeature& a, const WindowFeature& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.feature < b.feature;
  });
  Match match;
  if (best == window_.end() || best->distance > options_.max_distance) return match;
  // Features of the same spot on a far level are no rivals: they describe the landmark at another scale.
  for (auto rival = window_.begin(); rival != window_.end(); ++rival)
    if (rival != best && std::abs(rival->level - best->level) <= 1) match.second = std::min(match.second, rival->distance);
  if (options_.max_ratio < 1 && best->distance > options_.max_ratio * match.second) return Match{};
  match.feature = best->feature;
  match.distance = best->distance;
  return match;
}

std::span<const Match> GuidedMatcher::match(const Features& features, const FeatureGrid& grid,
                                            std::span<const ProjectedLandmark> landmarks,
                                            std::span<const Descriptor> descriptors) {
  std::fill(best_of_feature_.begin(), best_of_feature_.end(), Match{});
  for (const ProjectedLandmark& landmark : landmarks) {
    collect_window(features, grid, landmark, descriptors);
    Match match = best_in_window();
    if (match.feature < 0 || static_cast<std::size_t>(match.feature) >= best_of_feature_.size()) continue;
    match.landmark = landmark.landmark;
    Match& claimed = best_of_feature_[static_cast<std::size_t>(match.feature)];
    if (claimed.feature < 0 || match.distance < claimed.distance) claimed = match;
  }
  matches_.clear();
  for (const Match& match : best_of_feature_)
    if (match.feature >= 0 && matches_.size() < matches_.capacity()) matches_.push_back(match);
  return matches_;
}

}  // namespace camloc
