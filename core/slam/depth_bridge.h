// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Across a stretch without features: from the last frame that was tracked, the camera is followed by dense alignment of thumbnails
// until there is something to track again. What the frames do not say (where along a bare wall) is left to constant velocity, and
// the covariance knows; a bridge ends where that grows too large.
#pragma once

#include <cstdint>
#include <optional>

#include "core/dense/dense_alignment.h"
#include "core/dense/thumbnail.h"
#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// Not thread-safe.
class DepthBridge {
 public:
  DepthBridge(const RgbdCamera& camera, const SlamNumbers& numbers) : numbers_(numbers), aligner_(camera) {}

  /// A frame was tracked by its features: the next bridge begins here. Without a thumbnail there is none.
  void begin_at(std::int64_t stamp_ns, const Thumbnail& thumbnail);
  /// Tracking goes on somewhere else.
  void forget();

  struct Step {
    Rigid3 T_begin_camera;
    Matrix6d covariance = Matrix6d::Identity();  ///< of pose_error() of T_begin_camera, axes of the begin
  };
  /// The frame that followed, given where it is expected; nothing where it does not fit or too little is known by now, and then
  /// the bridge has ended.
  [[nodiscard]] std::optional<Step> step(std::int64_t stamp_ns, const Thumbnail& thumbnail, const Rigid3& T_begin_camera_expected);

  /// Frames have been bridged since begin_at().
  [[nodiscard]] bool is_open() const { return num_steps_ > 0; }

 private:
  SlamNumbers numbers_;
  DenseAligner aligner_;
  std::int64_t begin_ns_ = 0, last_ns_ = 0;
  int num_steps_ = 0;
  Thumbnail anchor_;
  Step anchor_step_, last_;  ///< where the anchor and the last frame are
};

}  // namespace camloc
