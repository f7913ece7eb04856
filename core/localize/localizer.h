// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where is this camera in the map? One call per frame, a bounded amount of work, nothing allocated, the same bits for the
// same input.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "core/base/stage_timer.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/localize/calibration_monitor.h"
#include "core/localize/coarse_hint.h"
#include "core/localize/gate.h"
#include "core/localize/localization.h"
#include "core/localize/localizer_numbers.h"
#include "core/localize/motion_parallax.h"
#include "core/localize/pose_hint.h"
#include "core/localize/proposer.h"
#include "core/localize/rival_poses.h"
#include "core/map/map_landmarks.h"
#include "core/map/map_view.h"
#include "core/registration/pose_solver.h"

namespace camloc {

struct LocalizerOptions {
  OrbOptions orb;
  bool use_tracking = true;  ///< false: every frame is a kidnapped robot
  bool use_depth = true;
  std::int64_t max_coast_ns = 500'000'000;  ///< COASTING ends this long after the last verified pose
  std::int64_t (*now_ns)() = nullptr;       ///< monotonic clock for stage times; core itself reads none
  LocalizerNumbers numbers;
};

/// Not thread-safe. `map` must outlive the localizer. Allocates at construction only.
class Localizer {
 public:
  Localizer(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& options,
            std::span<const ProposerEntry> proposers = proposer_table());
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  /// The reference stays valid until the next call.
  const Localization& process(const Frame& frame);
  /// The next frames are looked for there first; ignored unless valid.
  void hint(const PoseHint& hint);
  /// Looked at where nothing else leads to a pose, while it is current; ignored unless valid. Until then it is what COARSE says where
  /// no view of the map is alike.
  void coarse_hint(const CoarseHint& hint);
  /// Forgets the last pose.
  void reset();
  [[nodiscard]] const CalibrationHealth& calibration() const { return calibration_.health(); }

 private:
  void begin(const Frame& frame);
  [[nodiscard]] Reason observe(const Frame& frame);
  [[nodiscard]] Candidate examine(const Frame& frame, std::span<const Proposal> proposals, bool joins_earlier);
  void solve(const Proposal& proposal, std::uint64_t seed);
  void gather_candidates(const Proposal& place);
  void keep(const PoseEvidence& found);
  void ask_rivals(Hypothesis* best, std::uint64_t seed);
  [[nodiscard]] bool withstands_a_rival(Candidate* candidate, std::uint64_t seed);
  [[nodiscard]] RivalDistance apart() const { return {options_.numbers.rival_distance_m, options_.numbers.rival_angle_rad}; }
  [[nodiscard]] std::size_t best_of_found() const;
  [[nodiscard]] bool is_shown_no_picture(std::int64_t stamp_ns, const Candidate& candidate);
  void watch_calibration(const PoseEvidence& evidence);
  const Localization& accept(const Frame& frame, const Candidate& candidate, const char* proposed_by);
  const Localization& decline(const Frame& frame, const Candidate& candidate);
  const Localization& report(const Candidate& candidate);
  void set_pose(const Rigid3& T_map_camera, const Matrix6d& covariance, const RiskFeatures& features);
  void set_coarse_pose(std::int64_t stamp_ns);
  [[nodiscard]] Matrix6d with_map_uncertainty(const Matrix6d& covariance) const;

  const MapView* map_;
  RgbdCamera camera_;
  LocalizerOptions options_;
  StageTimer timer_;
  FrameExtractor extractor_;
  FrameFeatures view_;  ///< of the frame at hand
  RivalPoses rivals_;
  MapLandmarks landmarks_;
  PyramidLevels levels_;
  PoseSolver solver_;
  struct NamedProposer {
    const char* name;
    std::unique_ptr<Proposer> proposer;
  };
  std::vector<NamedProposer> proposers_;
  std::vector<Hypothesis> found_;                 ///< for the proposals at hand
  std::vector<std::uint32_t> list_;               ///< landmarks of one keyframe
  std::vector<std::uint32_t> visit_of_landmark_;  ///< the visit_ at which a landmark became a candidate
  std::uint32_t visit_ = 0;
  std::size_t rival_turn_ = 0;  ///< of tracked frames: which look-alike is asked next
  Gate gate_;
  MotionParallax parallax_;
  std::vector<LandmarkObservation> inliers_;       ///< of the pose at hand, for parallax_
  std::vector<LandmarkSighting> sightings_;        ///< the same
  Matrix6d shared_covariance_ = Matrix6d::Zero();  ///< of the last pose; the gate weighs poses without it
  CalibrationMonitor calibration_;
  RiskFeatures last_risk_features_{};  ///< of the last pose, while it is predicted from
  std::optional<CoarseHint> coarse_;   ///< the last one
  Localization result_;
};

}  // namespace camloc
