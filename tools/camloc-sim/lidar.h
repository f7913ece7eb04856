// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A survey's point cloud of everything that does not move: points spread evenly over the surfaces, in the world frame.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "tools/camloc-sim/scene.h"

namespace camloc::sim {

struct LidarOptions {
  double step_m = 0.03;    ///< between neighbouring points
  double noise_m = 0.002;  ///< sigma along the surface normal
  std::uint32_t seed = 1;
};

/// Binary little-endian PLY: float x y z, uchar intensity. Returns the number of points. Surfaces nobody would scan (inside
/// of furniture against a wall) are not left out.
[[nodiscard]] Result<std::uint64_t> write_lidar_ply(const std::string& path, const Scene& scene, const LidarOptions& options);

}  // namespace camloc::sim
