// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The poses of a recording's frames from a COLMAP model that was made of its colour images. How many metres a unit of the model
// is, images alone do not tell: the depth that was recorded with them does (colmap_scale.cc).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/io/sequence.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {

/// A point of the model as one image sees it.
struct DepthPair {
  std::uint32_t image = 0;      ///< which; numbers are only compared
  double model_depth = 0;       ///< along the optical axis, units of the model, > 0
  double measured_depth_m = 0;  ///< by the depth camera at the same pixel, > 0
};

struct ModelScale {
  double metres_per_unit = 1;
  double spread = 0;        ///< of single ratios, one robust standard deviation, relative
  double image_spread = 0;  ///< the same of the images' medians: drift of scale within the model
  std::uint64_t num_pairs = 0, num_images = 0;
};

/// "0.271 m a unit, from 80170 points in 60 images; scatter 1.2 %, drift between images 0.4 %": for a summary.
[[nodiscard]] std::string describe_scale(const ModelScale& scale);

/// Median of measured / model depth. The spreads are 1.4826 times the median absolute deviation of the logarithm of the ratio.
/// kInvalid, naming the numbers: too few pairs, or spreads above the limits, as with poses, images or a depth that do not
/// belong together.
[[nodiscard]] Result<ModelScale> estimate_model_scale(std::span<const DepthPair> pairs);

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
