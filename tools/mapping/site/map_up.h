// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which way is up in a map: what pictures and colours by height need to know.
#pragma once

#include <Eigen/Core>

#include "core/map/map_view.h"

namespace camloc::mapping {

/// Unit vector in `map`, pointing to the side to which the keyframes' image tops point on average. The z axis of the site where the map
/// has a datum; else what the keyframes' horizontal axes are perpendicular to (Snavely, Seitz, Szeliski, "Photo tourism", 2006),
/// or an axis of `map` within 5 degrees of that; where the cameras turned too little or rolled, the axis of `map` along which
/// landmarks (1st to 99th percentile) and keyframes extend least, which is what `camloc localize` draws along.
[[nodiscard]] Eigen::Vector3d up_axis(const MapView& map);

}  // namespace camloc::mapping
