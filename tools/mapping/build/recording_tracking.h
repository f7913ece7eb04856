// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The first pass over a recording without poses: SLAM says where each frame was, the frame log keeps what was seen. An interrupted pass
// goes on from its log.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/slam/slam.h"
#include "tools/common/frame_reading.h"
#include "tools/mapping/build/recording_check.h"

namespace camloc::mapping {

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
  std::uint64_t num_resumed = 0;        ///< views that came from the log
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
