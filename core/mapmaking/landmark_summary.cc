// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is known about each landmark once all views are in: position and its scatter, descriptors, viewing directions.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/features/hamming.h"
#include "core/mapmaking/landmark_fusion.h"

namespace camloc {

// Medoid first; then, while some sample is farther than kAppearanceDistance from all chosen, the sample that stands for the
// most of those left over.
void LandmarkFusion::choose_descriptors(const Fused& from, MapLandmark* to, std::vector<std::uint32_t>* support) const {
  const std::size_t count = from.samples.size();
  std::array<std::array<int, kMaxSamples>, kMaxSamples> distance{};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j)
      distance[i][j] = distance[j][i] = hamming_distance(from.samples[i].descriptor, from.samples[j].descriptor);
  }
  std::array<bool, kMaxSamples> is_covered{};
  while (to->descriptors.size() < kMaxDescriptors) {
    std::size_t best = count;
    int best_count = 0, best_sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (is_covered[i]) continue;
      int near = 0, sum = 0;
      for (std::size_t j = 0; j < count; ++j) {
        if (is_covered[j]) continue;
        near += distance[i][j] <= kAppearanceDistance ? 1 : 0;
        sum += distance[i][j];
      }
      const bool is_medoid_round = to->descriptors.empty();
      if (best == count || (is_medoid_round ? sum < best_sum : near > best_count || (near == best_count && sum < best_sum))) {
        best = i, best_count = near, best_sum = sum;
      }
    }
    if (best == count) return;
    if (to->descriptors.empty()) to->angle_rad = from.samples[best].angle_rad;
    to->descriptors.push_back(from.samples[best].descriptor);
    support->push_back(static_cast<std::uint32_t>(best_count));
    for (std::size_t j = 0; j < count; ++j) is_covered[j] = is_covered[j] || distance[best][j] <= kAppearanceDistance;
  }
}

void LandmarkFusion::set_viewing_directions(std::vector<MapLandmark>* landmarks) const {
  const auto to_camera = [&](std::size_t view, std::uint32_t index) -> Eigen::Vector3f {
    return (poses_[view].translation - landmarks_[index].position_m).normalized().cast<float>();
  };
  for (MapLandmark& landmark : *landmarks) landmark.direction.setZero();
  for (std::size_t view = 0; view < views_.size(); ++view) {
    for (const ViewObservation& o : views_[view]) (*landmarks)[o.landmark].direction += to_camera(view, o.landmark);
  }
  for (MapLandmark& landmark : *landmarks) {
    landmark.direction = landmark.direction.norm() > 1e-6F ? Eigen::Vector3f(landmark.direction.normalized()) : Eigen::Vector3f(0, 0, -1);
  }
  for (std::size_t view = 0; view < views_.size(); ++view) {
    for (const ViewObservation& o : views_[view]) {
      MapLandmark& landmark = (*landmarks)[o.landmark];
      landmark.view_cosine = std::min(landmark.view_cosine, std::max(-1.0F, landmark.direction.dot(to_camera(view, o.landmark))));
    }
  }
}

std::vector<MapLandmark> LandmarkFusion::landmarks(std::vector<std::vector<std::uint32_t>>* support) const {
  std::vector<MapLandmark> result(landmarks_.size());
  support->assign(landmarks_.size(), {});
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Fused& from = landmarks_[i];
    MapLandmark& to = result[i];
    to.position_m = from.position_m.cast<float>();
    to.min_reference_m = from.min_reference_m;
    to.max_reference_m = from.max_reference_m;
    to.num_observations = from.num_observations;
    const double n = from.num_observations;
    const double expected = std::sqrt(from.information.inverse().trace() / 3.0 * n);  // of one observation
    const Eigen::Vector3d mean = from.sum / n;
    const double scatter = std::sqrt(std::max(0.0, from.sum_squared / n - mean.squaredNorm()) / 3.0);
    // A handful of points says little about its own scatter: the expected one counts as two more observations.
    to.position_sigma_m = static_cast<float>(std::sqrt((n * scatter * scatter + 2.0 * expected * expected) / (n + 2.0)));
    choose_descriptors(from, &to, &(*support)[i]);
  }
  set_viewing_directions(&result);
  return result;
}

}  // namespace camloc
