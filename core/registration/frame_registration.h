// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pose of a view among a set of landmarks, as map making asks for it: with the landmarks that its features show, and with the
// limits of what counts as the same place. Tracking, relocalizing after a loss, closing loops and merging maps call these.
#pragma once

#include <cstdint>
#include <vector>

#include "core/registration/landmark_set.h"
#include "core/registration/pose_solver.h"
#include "core/registration/rivals.h"

namespace camloc {

struct Registration : PoseEvidence {
  std::vector<LandmarkObservation> inliers;  ///< LandmarkObservation::landmark: index in the map that the set is from
};

/// The solver of map making: it trusts many views later, so each costs less than on a device.
[[nodiscard]] PoseSolverOptions mapping_solver_options(int max_features, bool use_depth = true);

/// Looks for landmarks within `radius_px` of where a camera at `T_map_camera_predicted` would see them.
[[nodiscard]] Registration register_near(const FrameFeatures& view, const Rigid3& T_map_camera_predicted, float radius_px,
                                         std::uint64_t seed, LandmarkSet* landmarks, PoseSolver* solver);
/// From descriptors alone, then guided by what was found.
[[nodiscard]] Registration register_anywhere(const FrameFeatures& view, std::uint64_t seed, LandmarkSet* landmarks, PoseSolver* solver);

/// When a registration to a place far back in time is believed: looks alone are not enough, buildings repeat themselves.
struct PlaceLimits {
  std::uint32_t min_inliers = 40;
  double min_inlier_ratio = 0.4, min_depth_agreement = 0.7, min_spread = 0.15;
};

/// Enough landmarks fit, with pixels and with depth, spread over the image.
[[nodiscard]] bool is_convincing(const PoseEvidence& found, const PlaceLimits& limits);
/// `other` explains the view nearly as well as `best`, from another pose in the same frame.
[[nodiscard]] bool is_strong_rival(const PoseEvidence& other, const PoseEvidence& best);

}  // namespace camloc
