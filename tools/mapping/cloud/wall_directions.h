// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The three directions across which a building's floors and walls stand.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace camloc::mapping {

/// A rotation whose columns are the direction that most surfaces face, the one across it that most of the others face, and the
/// third. Surfaces are planes through neighbouring points, which are about a decimetre apart. Principal axes of the points
/// where there are no surfaces.
[[nodiscard]] Eigen::Matrix3d wall_directions(const std::vector<Eigen::Vector3d>& points_m);

}  // namespace camloc::mapping
