// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where is this camera in the map? One call per frame, a bounded amount of work, nothing allocated, the same bits for the
// same input.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/frame.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/localize/calibration_monitor.h"
#include "core/localize/global_search.h"
#include "core/localize/localization.h"
#include "core/localize/motion_model.h"
#include "core/localize/observations.h"
#include "core/localize/pose_estimator.h"
#include "core/localize/pose_hint.h"
#include "core/localize/stage_timer.h"
#include "core/localize/verification.h"
#include "core/map/map_view.h"

namespace camloc {

struct LocalizerOptions {
  OrbOptions orb;
  bool use_tracking = true;  ///< false: every frame is a kidnapped robot
  bool use_depth = true;
  std::int64_t max_coast_ns = 500'000'000;  ///< COASTING ends this long after the last verified pose
  std::int64_t (*now_ns)() = nullptr;       ///< monotonic clock for stage times; core itself reads none
};

/// Not thread-safe. `map` must outlive the localizer. Allocates at construction only.
class Localizer {
 public:
  Localizer(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& options);

  /// The reference stays valid until the next call.
  const Localization& process(const Frame& frame);
  /// A place to look first, in the frames that follow.
  void hint(const PoseHint& hint) { hint_ = hint; }
  /// Forgets the last pose.
  void reset();
  [[nodiscard]] const CalibrationHealth& calibration() const { return calibration_.health(); }

 private:
  /// A hypothesis together with the verdict on it.
  struct Candidate {
    PoseHypothesis hypothesis{};
    double margin = 1;
    bool is_tracked = false;
    Reason reason = Reason::kNotStarted;  ///< kNone: verified
  };

  void begin(const Frame& frame);
  [[nodiscard]] Candidate track(const Frame& frame);
  [[nodiscard]] Candidate search_globally(const Frame& frame);
  [[nodiscard]] bool fits_motion(const Frame& frame, const PoseHypothesis& hypothesis) const;
  [[nodiscard]] bool is_confirmed(const Frame& frame, const PoseHypothesis& hypothesis);
  [[nodiscard]] bool was_ambiguous(const Frame& frame, const PoseHypothesis& hypothesis) const;
  void watch_calibration(const PoseHypothesis& hypothesis);
  const Localization& accept(const Frame& frame, const Candidate& candidate);
  const Localization& decline(const Frame& frame, const Candidate& candidate);
  const Localization& finish(const Candidate& candidate);
  [[nodiscard]] Matrix6d with_map_uncertainty(const Matrix6d& covariance) const;
  [[nodiscard]] bool is_recent(std::int64_t stamp_ns, std::int64_t max_age_ns) const;

  const MapView* map_;
  LocalizerOptions options_;
  StageTimer timer_;
  FrameObservations observations_;
  PoseEstimator estimator_;
  GlobalSearch global_search_;
  MotionModel motion_;
  MotionModel unconfirmed_;                   ///< the last fix that contradicts the motion so far
  std::int64_t unconfirmed_since_ns_ = 0;     ///< when fixes that agree with it began
  std::optional<std::int64_t> ambiguous_ns_;  ///< when another place last explained a frame nearly as well
  CalibrationMonitor calibration_;
  VerificationOptions verification_;
  double focal_px_;
  std::optional<PoseHint> hint_;
  Localization result_;
};

}  // namespace camloc
