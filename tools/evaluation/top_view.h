// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A picture of a map from above with the truth and an estimate in it.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/rigid3.h"
#include "core/map/map_view.h"

namespace camloc::tools {

struct TopView {
  const MapView* map = nullptr;  ///< landmarks and keyframes, may be null
  std::vector<Rigid3> truth;     ///< T_map_camera, drawn as a line
  std::vector<Rigid3> estimate;  ///< drawn as dots with a tick along the viewing direction
  std::vector<double> error_m;   ///< per estimate: colours the dot; empty = unknown
  std::string title;
};

/// Draws along the axis in which the landmarks and positions spread least (the vertical in most recordings) and writes a
/// PNG 1200 pixels wide.
[[nodiscard]] Status write_top_view(const TopView& view, const std::string& path);

}  // namespace camloc::tools
