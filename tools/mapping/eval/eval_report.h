// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What an evaluation says: a table for people, JSON for programs.
// And pictures: how the distances are distributed, and where they are (eval_pictures.cc).
#pragma once

#include <string>
#include <vector>

#include "core/io/image_file.h"
#include "tools/mapping/cloud/point_cloud.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {

struct EvalSummary {
  std::string map_path, cloud_name;
  std::uint64_t num_read = 0, num_invalid = 0, num_points = 0;  ///< of the cloud
  double voxel_m = 0;
  std::uint32_t min_observations = 0;
  Evaluation evaluation;
  std::vector<std::string> files;  ///< that were written
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const EvalSummary& summary);
[[nodiscard]] std::string format_json(const EvalSummary& summary);

/// What to be careful about: one line each, that begins with a word in capitals: SCALE, VOLUME, POINTS, START, OVERLAP, SLIDING, ICP.
[[nodiscard]] std::vector<std::string> warnings_of(const Evaluation& evaluation);

/// Landmark-to-point distances in steps of 2.5 mm up to 10 cm and the rest, with mean, median and 95th percentile.
[[nodiscard]] ColorImage draw_histogram(const CloudDistances& distances, const std::string& title);

/// Landmarks by distance (dark blue: on the cloud, yellow: 10 cm and more) over the cloud in grey, with the keyframes. From
/// above, where what is over the cameras' heads is cut off as in a floor plan, or from the side. Up is where the cameras' up is
/// on average, corrected to what is within 30 degrees: the cloud's z axis, or else a direction across walls and floors.
enum class CloudView { kTop, kSide };
[[nodiscard]] ColorImage draw_cloud_view(const Evaluation& evaluation, const PointCloud& cloud, CloudView view, const std::string& title);

}  // namespace camloc::mapping
