// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The poses that a recording brings along, as poses of its colour camera.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/io/sequence.h"

namespace camloc::tools {

struct RecordedPoses {
  std::vector<StampedPose> poses;  ///< T_world_camera of the colour camera, of the selected frames that have one
  std::uint64_t num_frames = 0;    ///< selected ones, with and without a pose
};

/// `frames` is a selection in the notation of --frames, empty for all. `T_color_depth` is set where the recorded poses belong to the
/// depth camera.
[[nodiscard]] Result<RecordedPoses> read_recorded_poses(const std::string& folder, const std::string& frames,
                                                        const std::optional<Rigid3>& T_color_depth);

}  // namespace camloc::tools
