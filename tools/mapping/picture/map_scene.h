// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the panels of a map's picture share: landmarks with colours by height, keyframes, the walk, and the plan that puts
// walls along the edges of the picture.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "core/map/map_view.h"
#include "core/mapmaking/localizability.h"
#include "tools/mapping/picture/point_raster.h"
#include "tools/mapping/picture/weak_places.h"

namespace camloc::mapping {

/// What there is to draw.
struct MapPicture {
  const MapView* map = nullptr;
  std::vector<KeyframeLocalizability> places;  ///< one a keyframe
  std::vector<WeakPlace> weak;                 ///< numbered in the picture from 1
  std::vector<Rigid3> trajectory;              ///< T_map_camera in order; may be empty
};

struct Scene {
  const MapPicture* picture = nullptr;
  Eigen::Vector3d up;
  std::vector<Eigen::Vector3d> landmarks;        ///< below the cut
  std::vector<Rgb> colors;                       ///< of the landmarks, by height
  std::vector<Eigen::Vector3d> keyframes, walk;  ///< positions
  double low_m = 0, high_m = 0;                  ///< heights at the ends of the ramp
  bool is_cut = false;                           ///< something was left out above
};

[[nodiscard]] Scene make_scene(const MapPicture& picture);

/// The part of the value ramp that shows on white, and on which cameras show.
[[nodiscard]] std::span<const Rgb> paper_ramp();

struct Extent {
  double low = 0, high = 0;
  [[nodiscard]] double length() const { return std::max(0.1, high - low); }
};

/// From above with the walls along the picture's edges and the longer side to the right. Holds landmarks from the 1st to the 99th
/// percentile and everything that was walked.
struct Plan {
  Eigen::Vector3d right, down;  ///< unit vectors
  Extent u, v;                  ///< along them, metres
};

[[nodiscard]] Plan make_plan(const Scene& scene);
[[nodiscard]] Viewpoint top_view(const Plan& plan, int width, int height, int margin_px);

}  // namespace camloc::mapping
