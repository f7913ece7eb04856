// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// When control points fit no rigid motion as they are: would they with other axes or in other units?
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/geometry/alignment.h"

namespace camloc::mapping {

/// A sentence such as "the residuals drop from 3.20 m to 0.02 m with x and y swapped: ..."; empty where nothing helps,
/// that is where no change makes more pairs agree than the `num_agreeing` that do without one.
/// A mirror image is one whichever axis is turned over, and any order of axes is a rotation of it: `up_map` (in the map,
/// rough) says which one it was, as long as z of the site is up.
[[nodiscard]] std::string explain_misfit(std::span<const PointPair> pairs, std::size_t num_agreeing, double tolerance_m,
                                         const std::optional<Eigen::Vector3d>& up_map);

/// Points in a plane fit their mirror image just as well, upside down: a sentence where that is what happened, else empty.
[[nodiscard]] std::string explain_upside_down(std::span<const PointPair> pairs, const Alignment& fit, const Eigen::Vector3d& up_map);

/// A warning where the fitted site has its z axis not up; empty where it is.
[[nodiscard]] std::string check_up(const Rigid3& T_wcs_map, const Eigen::Vector3d& up_map);

}  // namespace camloc::mapping
