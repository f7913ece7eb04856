// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A sheet that shows a map: from above, in perspective, and where a fix is to be expected. Its panels share a Scene (map_scene.cc):
// landmarks with colours by height, keyframes, the trajectory; and the plan that puts walls along the edges of the picture.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/io/image_file.h"
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

enum class MapPanel { kTop, kPerspective, kCoverage, kAll };

/// Colours that keep apart for colour-blind readers (Okabe and Ito, "Color universal design", 2008) and in grey.
[[nodiscard]] Rgb color_of(FixOutlook outlook);

/// The sheet, `width_px` wide and as high as it needs. width_px from 400 to 8000.
[[nodiscard]] ColorImage draw_map(const MapPicture& picture, MapPanel panel, int width_px);

struct Scene {
  const MapPicture* picture = nullptr;
  Eigen::Vector3d up;
  std::vector<Rigid3> keyframes;           ///< T_map_camera
  std::vector<Eigen::Vector3d> landmarks;  ///< below the cut
  std::vector<Rgb> colors;                 ///< of the landmarks, by height
  double low_m = 0, high_m = 0;            ///< heights at the ends of the ramp
  bool is_cut = false;                     ///< something was left out above
};

[[nodiscard]] Scene make_scene(const MapPicture& picture);

/// The part of the value ramp that shows on white, and on which cameras show.
[[nodiscard]] std::span<const Rgb> paper_ramp();

/// From above with the walls along the picture's edges and the longer side to the right. Holds landmarks from the 1st to the 99th
/// percentile, all keyframes and the trajectory.
struct Plan {
  Eigen::Vector3d right, down;  ///< unit vectors
  Extent u, v;                  ///< along them, metres
};

[[nodiscard]] Plan make_plan(const Scene& scene);
[[nodiscard]] Viewpoint top_view(const Plan& plan, int width, int height, int margin_px);

}  // namespace camloc::mapping
