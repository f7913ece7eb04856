// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which frames of a recording go into a map, and where the colour camera was when they were taken.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {

enum class PoseCamera { kAuto, kColor, kDepth };

struct PosedFramesRequest {
  std::string sequence;                        ///< replay://DIR or DIR
  std::string poses = "embedded";              ///< or a TUM trajectory file, or colmap:FOLDER of a text model of the colour images
  std::string include, exclude;                ///< Python slices
  double pair_ms = 20;                         ///< how far a colour image and its depth image may be apart
  PoseCamera pose_camera = PoseCamera::kAuto;  ///< whose poses they are; kAuto: embedded ones as the camera file says, files colour
};

/// The chosen frames of a recording, whatever is known about where they were.
struct SelectedFrames {
  std::string folder;
  std::string url;  ///< for open_frame_source
  std::uint64_t num_recorded = 0, num_selected = 0;
  bool has_depth = false;          ///< any of the recording has
  std::vector<std::string> notes;  ///< what was left out of recording and poses, for people: a line each
};

/// Reads `sequence`, `include` and `exclude` of the request only.
[[nodiscard]] Result<SelectedFrames> find_frames(const PosedFramesRequest& request);

/// Those of them that have a pose; `url` has only these.
struct PosedFrames : SelectedFrames {
  std::map<std::uint64_t, Rigid3> T_map_camera_of_frame;    ///< by index in the whole recording
  std::map<std::uint64_t, std::int64_t> stamp_ns_of_frame;  ///< of the same frames
  std::uint64_t num_without_pose = 0;
  std::optional<ModelScale> scale;  ///< how a COLMAP model was brought to metres
};

/// URL of these frames of the recording in `folder`, paired as the request says.
[[nodiscard]] std::string recording_url(const PosedFramesRequest& request, const std::string& folder,
                                        const std::vector<std::uint64_t>& frames);

/// Errors: those of reading the sequence and the poses, a URL that is no recording, a selection without any posed frame, a
/// COLMAP model as poses of the depth camera.
[[nodiscard]] Result<PosedFrames> find_posed_frames(const PosedFramesRequest& request, const RgbdCamera& camera);

}  // namespace camloc::mapping
