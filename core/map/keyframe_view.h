// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A keyframe of a finished map as if it were an image again: its landmarks where its camera saw them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_data.h"
#include "core/registration/frame_features.h"

namespace camloc {

struct KeyframeView {
  FrameFeatures view;                    ///< one feature a landmark, with its first descriptor
  std::vector<std::uint32_t> landmarks;  ///< of each feature
};

/// Landmarks that the pose puts outside the image are left out; those beyond the depth camera's range have no depth.
[[nodiscard]] KeyframeView view_of_keyframe(const MapData& map, std::uint32_t keyframe);

}  // namespace camloc
