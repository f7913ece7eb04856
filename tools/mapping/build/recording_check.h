// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is wrong with a recording, and where: recordings that cannot become a map are refused with a reason, weak spots of the others
// are named together with what to do about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/slam/slam.h"

namespace camloc::mapping {

/// A stretch of the recording where the map will be thin or missing.
struct WeakSpot {
  std::uint64_t first_frame = 0, last_frame = 0;  ///< indices in the recording
  std::string what;                               ///< "lost", "few landmarks", ...
  std::string advice;                             ///< what to do about it
};

class RecordingCheck {
 public:
  /// What is remembered of a frame.
  struct Note {
    std::uint64_t frame = 0;
    bool is_lost = false, is_jump = false;
    int num_inliers = 0;
    std::size_t num_features = 0, num_with_depth = 0;
  };

  explicit RecordingCheck(const RgbdCamera& camera) : camera_(camera) {}

  /// Before tracking: depth missing, constant, in the wrong unit. `num_with_depth` features of `num_features` have depth.
  void see_frame(const Frame& frame, std::size_t num_features, std::size_t num_with_depth);
  /// The same for a view whose images are gone.
  void see_view(std::uint64_t frame, std::int64_t stamp_ns, std::size_t num_features, std::size_t num_with_depth);
  /// After tracking of the same frame.
  void see_report(const FrameReport& report);

  /// kInvalid when no map should be made of this: no depth, constant depth, a camera that never moved.
  [[nodiscard]] Status verdict(const SlamResult& result) const;
  /// The earliest moment a recording without usable depth can be given up.
  [[nodiscard]] Status early_verdict() const;
  [[nodiscard]] std::vector<WeakSpot> weak_spots() const;
  [[nodiscard]] std::uint64_t num_stamp_jumps() const { return num_jumps_; }

 private:
  RgbdCamera camera_;
  std::vector<Note> notes_;
  std::int64_t last_stamp_ns_ = 0;
  std::uint64_t num_jumps_ = 0, num_seen_ = 0, num_constant_ = 0, num_without_depth_ = 0;
  std::uint16_t constant_value_ = 0;
};

}  // namespace camloc::mapping
