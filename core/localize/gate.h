// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Is a verified pose believed, given what came before? The only thing in the localizer that remembers: the last pose and its motion
// (motion_model.h), and what speaks for other places (place_belief.h).
#pragma once

#include <cstdint>
#include <optional>

#include "core/localize/localization.h"
#include "core/localize/localizer_numbers.h"
#include "core/localize/motion_model.h"
#include "core/localize/place_belief.h"
#include "core/registration/rivals.h"

namespace camloc {

/// The best pose for a frame, together with the verdict on it.
struct Candidate {
  PoseEvidence evidence{};
  Standing standing{};
  bool is_continuation = false;         ///< found where the motion so far predicts it
  bool overrides_motion = false;        ///< found where somebody said, who knows better
  Reason reason = Reason::kNotStarted;  ///< kNone: verified
};

class Gate {
 public:
  /// Without memory every frame is a kidnapped robot.
  Gate(const LocalizerNumbers& numbers, bool has_memory);

  void reset();
  /// A frame begins; a clock that runs backwards ends what was known.
  void begin(std::int64_t stamp_ns);

  struct Prediction {
    Rigid3 T_map_camera;
    Matrix6d covariance;  ///< convention of pose_error()
  };
  /// Where the motion leads, while that is better than a look at the whole map.
  [[nodiscard]] std::optional<Prediction> predict(std::int64_t stamp_ns) const {
    return predict(stamp_ns, ns(numbers_.max_tracking_gap_s));
  }
  /// The same for as long as the caller wants.
  [[nodiscard]] std::optional<Prediction> predict(std::int64_t stamp_ns, std::int64_t max_age_ns) const;

  /// A tracked pose was held against one of its look-alikes. False: the look-alike has gained on it for so long that neither is
  /// believed, and the motion is forgotten.
  [[nodiscard]] bool withstands(const Candidate& candidate, const Rigid3& T_map_rival, double lead);
  /// What becomes of the candidate's reason. Takes notice of places that look alike.
  [[nodiscard]] Reason judge(std::int64_t stamp_ns, const Candidate& candidate);
  /// Believed, but the next proposer is asked as well: a tracked pose on thin evidence that has lost most of what the last one had. A
  /// pattern that repeats agrees with itself one period off, but then the rest of the image does not.
  [[nodiscard]] bool is_doubtful(const Candidate& candidate) const;
  /// The candidate is the pose. Returns how far that is from the prediction where the pose is no continuation, else 0.
  double accept(std::int64_t stamp_ns, const Candidate& candidate);

 private:
  static std::int64_t ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }
  [[nodiscard]] bool is_thin(const Candidate& candidate) const { return candidate.evidence.num_inliers < numbers_.strong_inliers; }
  [[nodiscard]] bool is_recent(std::int64_t stamp_ns, std::int64_t max_age_ns) const;
  [[nodiscard]] bool fits_motion(std::int64_t stamp_ns, const Candidate& candidate) const;
  [[nodiscard]] bool is_confirmed(std::int64_t stamp_ns, const Candidate& candidate);
  [[nodiscard]] bool is_contested(std::int64_t stamp_ns, const Candidate& candidate) const;

  LocalizerNumbers numbers_;
  bool has_memory_;
  MotionModel motion_;
  PlaceBelief belief_;
  std::uint32_t num_last_inliers_ = 0;  ///< of the last pose
};

}  // namespace camloc
