// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pictures of an evaluation: how the distances are distributed, and where they are.
#pragma once

#include <string>

#include "core/io/image_file.h"
#include "tools/mapping/cloud/point_cloud.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {

/// Landmark-to-point distances in steps of 2.5 mm up to 10 cm and the rest, with mean, median and 95th percentile.
[[nodiscard]] ColorImage draw_histogram(const CloudDistances& distances, const std::string& title);

/// Landmarks by distance (dark blue: on the cloud, yellow: 10 cm and more) over the cloud in grey, with the keyframes. From
/// above, where what is over the cameras' heads is cut off as in a floor plan, or from the side. Up is where the cameras' up is
/// on average, corrected to what is within 30 degrees: the cloud's z axis, or else a direction across walls and floors.
enum class CloudView { kTop, kSide };
[[nodiscard]] ColorImage draw_cloud_view(const Evaluation& evaluation, const PointCloud& cloud, CloudView view, const std::string& title);

}  // namespace camloc::mapping
