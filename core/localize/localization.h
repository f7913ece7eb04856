// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the localizer says about a frame: a verified pose with its covariance, or why there is none.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/stage_timer.h"
#include "core/geometry/rigid3.h"
#include "core/localize/integrity.h"
#include "core/registration/rivals.h"

namespace camloc {

enum class State : std::uint8_t {
  kNoCamera,   ///< no frames arrive (set by the daemon)
  kNoMap,      ///< no map is open (set by the daemon)
  kLost,       ///< no idea
  kCoarse,     ///< a candidate place, not verified: do not use as a pose
  kLocalized,  ///< verified pose
  kCoasting,   ///< predicted from the last verified pose, covariance growing
};

/// Why a frame is not LOCALIZED.
enum class Reason : std::uint8_t {
  kNone,
  kNotStarted,
  kNoImage,       ///< empty or of the wrong size
  kFewFeatures,   ///< black, white, blurred away
  kNoCandidates,  ///< retrieval found no view alike
  kFewMatches,
  kFewInliers,
  kLowInlierRatio,
  kPoorSpread,           ///< inliers crowd in one corner of the image
  kAmbiguous,            ///< a second place explains the image nearly as well
  kDepthInconsistent,    ///< measured depth contradicts the pose
  kCalibrationMismatch,  ///< images fit the map only with another focal length
  kImplausibleMotion,
  kUncertain,  ///< covariance too large to be of use
  kMapDamaged,
  kNoParallax,  ///< without depth, and the motion has not shown yet that this is the place and no picture of it
};

[[nodiscard]] const char* to_string(State state);
[[nodiscard]] const char* to_string(Reason reason);
[[nodiscard]] const char* to_string(Stage stage);

struct Localization {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
  State state = State::kLost;
  Reason reason = Reason::kNotStarted;
  bool has_pose = false;  ///< T_map_camera is set (LOCALIZED, COASTING; COARSE: the candidate)
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Zero();  ///< of pose_error(): metres, radians, axes of `map`
  int quality = -1;                        ///< 0..100, -1 when there is no pose
  double integrity_risk = 1;               ///< that the pose is off by more than 25 cm or 10 deg; 1 when there is none
  Protection protection;                   ///< radii that hold the error of a pose at the right place
  bool is_tracked = false;                 ///< found from the prediction, not by global search
  const char* proposed_by = "";            ///< who said where to look (proposers.cc), of a LOCALIZED pose
  std::uint32_t num_features = 0;
  PoseEvidence evidence;                            ///< of the pose, or of the best candidate for one; before motion and map are asked
  Standing standing;                                ///< of that pose against rival places
  std::uint32_t reset_counter = 0;                  ///< grows with every global fix: poses before and after may differ by a jump
  double jump_m = 0;                                ///< size of that jump, 0 while tracking
  std::array<std::int64_t, kNumStages> stage_ns{};  ///< zero when no clock was given
};

/// Health of the calibration, gathered over frames.
struct CalibrationHealth {
  bool is_suspect = false;       ///< the assumed focal length does not fit the map
  double focal_scale = 1;        ///< true / assumed, median of the recent frames
  std::uint32_t num_frames = 0;  ///< that took part
};

}  // namespace camloc
