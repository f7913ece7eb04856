// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/landmark_set.h"

#include <cmath>

namespace camloc {
namespace {

/// A landmark that few views have seen says little about the angles it may be seen from: one cone about their mean for all.
constexpr ProjectionLimits kLimits{.min_depth_m = 0.1, .max_range_m = 40.0, .view_angle_margin_rad = 1.05, .level_margin = 1};
constexpr float kMeanDirectionOnly = 1.0F;  // cosine

}  // namespace

LandmarkSet::LandmarkSet(const Intrinsics& color, const PyramidLevels& levels) : projector_(color, levels, kLimits) {}

void LandmarkSet::clear() {
  landmarks_.clear();
  descriptors_.clear();
}

void LandmarkSet::add(const Entry& landmark) {
  landmarks_.push_back({landmark.id, landmark.position_m.cast<float>(), landmark.direction.cast<float>(),
                        std::log(landmark.min_reference_m), std::log(landmark.max_reference_m), landmark.angle_rad,
                        static_cast<std::uint32_t>(descriptors_.size()), static_cast<std::uint32_t>(landmark.descriptors.size())});
  descriptors_.insert(descriptors_.end(), landmark.descriptors.begin(), landmark.descriptors.end());
}

std::span<const ProjectedLandmark> LandmarkSet::project(const Rigid3& T_map_camera, float radius_px) {
  projected_.clear();
  projector_.aim(T_map_camera, radius_px);
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    LandmarkProjector::Seen seen;
    if (!projector_.is_in_view(landmark.position_m, &seen)) continue;
    ProjectedLandmark projected;
    if (!projector_.is_recognizable(seen, landmark.direction, kMeanDirectionOnly, landmark.log_min_reference, landmark.log_max_reference,
                                    &projected))
      continue;
    projected.landmark = static_cast<std::int32_t>(i);
    projected.first_descriptor = landmark.first_descriptor;
    projected.num_descriptors = landmark.num_descriptors;
    projected_.push_back(projected);
  }
  return projected_;
}

void LandmarkSet::append_candidates(CandidateSet* candidates) const {
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    for (std::uint32_t d = 0; d < landmark.num_descriptors; ++d) {
      if (!candidates->add(descriptors_[landmark.first_descriptor + d], static_cast<std::int32_t>(i), landmark.angle_rad)) return;
    }
  }
}

}  // namespace camloc
