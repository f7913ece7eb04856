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
#include "core/slam/slam_map.h"

namespace camloc {

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
                                                            WorkObserver& observer, MapRegistrationReport* report);

/// For each keyframe those that share at least `min_shared` landmarks with it, most first, ties by index.
[[nodiscard]] std::vector<std::vector<CovisibleKeyframe>> find_covisible_keyframes(const MapData& map, std::uint32_t min_shared);

}  // namespace camloc
