// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The poses of a recording's frames from a COLMAP model that was made of its colour images.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/io/sequence.h"
#include "tools/mapping/colmap/colmap_model.h"
#include "tools/mapping/colmap/colmap_scale.h"

namespace camloc::mapping {

struct ColmapPoses {
  std::vector<std::optional<Rigid3>> T_map_camera;  ///< of the colour camera, per frame of the recording; metres
  ModelScale scale;
};

/// Frame index of each image of the model: the frame whose colour file has the same name; folders in front do not count.
/// kInvalid, naming the image: a name that no frame or several frames have, or that two images have.
[[nodiscard]] Result<std::vector<std::size_t>> match_image_names(const ColmapModel& model, const Sequence& sequence);

/// Reads the model, matches names, measures its scale at up to 60 images evenly over the recording, and turns poses into
/// metres. The map's frame is the model's, scaled. Errors: those of read_colmap_model, match_image_names and
/// estimate_model_scale, and another image size than the camera's.
[[nodiscard]] Result<ColmapPoses> read_colmap_poses(const std::string& folder, const Sequence& sequence, const RgbdCamera& camera);

}  // namespace camloc::mapping
