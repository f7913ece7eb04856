// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the keyframes of one map lie in another map of the same building. Each keyframe is asked as a query made of its own
// landmarks: words propose places, geometry verifies, a rival place that explains it nearly as well refuses it. Then the
// answers have to agree with each other: buildings repeat themselves, and one false fix would glue a floor onto another. What
// the majority leaves open is looked up again around the place that it predicts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/map/map_data.h"
#include "core/map/map_view.h"
#include "core/map/retrieval.h"
#include "core/registration/frame_registration.h"
#include "core/registration/landmark_set.h"

namespace camloc {

struct MapRegistrationOptions {
  std::uint32_t max_queries = 400;   ///< keyframes asked without a prediction, evenly spread
  std::uint32_t num_retrieved = 40;  ///< places that look alike
  std::uint32_t num_candidates = 6;  ///< of those, not yet part of another one's surroundings, asked for geometry
  std::uint32_t keyframes_per_place = 6;
  std::uint32_t max_place_landmarks = 3000;
  std::uint32_t min_shared = 20;  ///< landmarks that make two keyframes neighbours
  PlaceLimits place{.min_inliers = 30, .min_inlier_ratio = 0.3, .min_depth_agreement = 0.6};
  // How far two fixes may differ in the motion between the maps: they are bent against each other by their drift.
  double agreement_m = 0.10, agreement_rad = 0.04;
  double drift_per_m = 0.02, drift_rad_per_m = 0.002;  ///< more for each metre between them
  std::uint32_t min_fixes = 4;                         ///< that agree
  double min_extent_m = 0.5, min_extent_rad = 0.5;     ///< over which those are spread, one of the two
  double max_rival_group_share = 0.5;                  ///< of fixes that agree on another motion
  float guided_radius_px = 25;                         ///< of the look around a predicted pose
};

/// A keyframe of B where A's landmarks put it.
struct KeyframeFix {
  std::uint32_t keyframe = 0;
  Rigid3 T_a_camera;
  Matrix6d covariance = Matrix6d::Identity();  ///< of pose_error(), axes of A
  std::uint32_t num_inliers = 0;
};

struct MapRegistrationReport {
  std::uint32_t num_queries = 0;      ///< keyframes asked without a prediction
  std::uint32_t num_convincing = 0;   ///< of those, with a fix of their own
  std::uint32_t num_disagreeing = 0;  ///< of those, refused because the majority says something else
};

/// One per keyframe of B that was found in A, ascending. `a_data` is what unpack_map(a) gives.
/// Errors: kInvalid when too few keyframes agree on where they are, kUnavailable when `observer` said so.
[[nodiscard]] Result<std::vector<KeyframeFix>> register_map(const MapView& a, const MapData& a_data, const MapData& b,
                                                            const MapRegistrationOptions& options, WorkObserver& observer,
                                                            MapRegistrationReport* report);

/// Keyframes that share landmarks.
struct SharedLandmarks {
  std::uint32_t keyframe = 0, num_shared = 0;
};
/// For each keyframe those that share at least `min_shared` landmarks with it, most first, ties by index.
[[nodiscard]] std::vector<std::vector<SharedLandmarks>> find_covisible_keyframes(const MapData& map, std::uint32_t min_shared);

}  // namespace camloc
