// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses from outside against what images and depth show: the relative motion of neighbouring frames, which a registration of the two
// measures without any pose. Where they contradict each other, the usual misunderstandings are tried: inverted poses, quaternions in
// another order, other axes, another clock, another unit of length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc {

struct GivenPose {
  std::int64_t stamp_ns = 0;
  Rigid3 T_map_camera;
};

/// What two frames show of the motion between them.
struct SeenMotion {
  std::size_t from = 0, to = 0;  ///< indices of the given poses
  Rigid3 T_from_to;
};

/// Medians over the motions.
struct PoseMisfit {
  double translation_m = 0, rotation_rad = 0;
  double score = 0;  ///< of the larger of both, in tolerances: see kToleranceM in the .cc; below 1 is agreement
};

struct PoseVerdict {
  std::size_t num_motions = 0;         ///< large enough to tell; with fewer than kMinMotions there is no verdict
  double moved_m = 0, turned_rad = 0;  ///< medians of what was seen
  PoseMisfit given;
  std::string explanation;            ///< the misunderstanding that makes them fit; empty: none was found, or none is needed
  std::optional<PoseMisfit> fitting;  ///< with it
  double sigma_m = 0, sigma_rad = 0;  ///< per axis, what the given poses are off by from one to the next; 0 where registrations explain it

  static constexpr std::size_t kMinMotions = 8;
  /// A map made of the poses would mislead.
  [[nodiscard]] bool is_contradicted() const;
};

/// `poses` ascend in time. Pure: the same input gives the same bits.
[[nodiscard]] PoseVerdict judge_poses(std::span<const GivenPose> poses, std::span<const SeenMotion> motions);

}  // namespace camloc
