// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One map moved into the frame of another one: its keyframes settle in a pose graph between what they know of each other and
// where they were found in the other map, which stays as it is; landmarks go with the keyframes that see them.
#pragma once

#include <span>
#include <vector>

#include "core/map/map_data.h"
#include "core/merge/map_registration.h"

namespace camloc {

struct MapAlignmentReport {
  Rigid3 T_a_b;                             ///< the rigid part of the motion
  Matrix6d covariance = Matrix6d::Zero();   ///< of T_a_b, see pose_error()
  double residual_m = 0, residual_rad = 0;  ///< median over the fixes: from where the graph puts their keyframes
  double deformation_m = 0;                 ///< largest step of a keyframe beyond T_a_b
};

/// Moves poses and landmarks of `b` in place; lists, words and datum are left alone. `fixes` is not empty.
MapAlignmentReport align_map(std::span<const KeyframeFix> fixes, MapData* b);

}  // namespace camloc
