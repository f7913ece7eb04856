// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The first pass over a recording without poses: SLAM says where each frame was, the frame log keeps what was seen. An interrupted pass
// goes on from its log.
// What is wrong with a recording, and where (recording_check.cc): one that cannot become a map is refused with a reason, weak spots of
// the others are named together with what to do about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/slam/slam.h"
#include "tools/common/frame_reading.h"

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
  /// The same for a frame whose images are gone.
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

struct TrackingRequest {
  std::string url;               ///< for open_frame_source
  std::uint64_t num_frames = 0;  ///< that it will deliver, 0 = unknown
  RgbdCamera camera;
  OrbOptions orb;
  SlamOptions slam;
  std::string log_path;     ///< of the frame log
  bool is_resumed = false;  ///< go on from the log
};

/// Surfaces as a keyframe saw them, in its camera frame.
struct KeyframeSurface {
  std::uint64_t frame = 0;
  std::vector<Eigen::Vector3f> points_m;
};

/// How the pass ended.
struct RecordingEnd {
  std::vector<KeyframeSurface> surfaces;
  bool is_interrupted = false;          ///< what is there is a map of the first part
  std::uint64_t num_resumed = 0;        ///< frames that came from the log
  tools::FrameCounts reading;           ///< of this pass, without what came from the log
  std::uint64_t num_without_depth = 0;  ///< colour images without a depth image
};

/// A coarse look at the surfaces in a depth image, for finding the floor: points in the colour camera's frame, metres, on a grid of
/// 20 x 15 over the image, where there is depth.
[[nodiscard]] std::vector<Eigen::Vector3f> sample_surface(const RgbdCamera& camera, ImageView<std::uint16_t> depth);

/// What makes a log belong to a build.
[[nodiscard]] std::uint64_t recording_identity(const TrackingRequest& request);

/// Feeds all frames to `slam`; `check` gathers what is wrong with them. Errors: those of the source and of the log, a frame of
/// the wrong size.
[[nodiscard]] Result<RecordingEnd> track_recording(const TrackingRequest& request, Slam* slam, RecordingCheck* check,
                                                   WorkObserver& observer);

}  // namespace camloc::mapping
