// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A coarse look at the surfaces in a depth image, for finding the floor.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"

namespace camloc::mapping {

/// Points in the colour camera's frame, metres, on a grid of 20 x 15 over the depth image, where there is depth.
[[nodiscard]] std::vector<Eigen::Vector3f> sample_surface(const RgbdCamera& camera, ImageView<std::uint16_t> depth);

}  // namespace camloc::mapping
