// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A sheet that shows a map: from above, in perspective, and where a fix is to be expected. Its panels share a Scene (map_scene.cc):
// landmarks with colours by height, keyframes, the trajectory; and the plan that puts walls along the edges of the picture.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/io/image_file.h"
#include "core/map/map_view.h"
#include "core/mapmaking/localizability.h"
#include "tools/mapping/picture/point_raster.h"

namespace camloc::mapping {

/// Neighbouring keyframes of the same outlook that look the same way, spoken for by the worst of them. Of two places that look like
/// each other one is named.
struct WeakPlace {
  std::uint32_t keyframe = 0;
  std::uint32_t num_keyframes = 1;
  FixOutlook outlook = FixOutlook::kScanAgain;
};

/// "a fix is likely", ...: the words of table, legend and documentation.
[[nodiscard]] const char* words_for(FixOutlook outlook);

/// The worst first, at most `max_each` of each outlook: places to scan again by expected sigma, look-alike places by the share
/// of the view that another place explains. Keyframes within 2 m that look within 60 degrees of the same way are one place.
[[nodiscard]] std::vector<WeakPlace> find_weak_places(const MapView& map, const std::vector<KeyframeLocalizability>& places,
                                                      std::size_t max_each);

/// Why, and what to do: one line without the position.
[[nodiscard]] std::string explain(const MapView& map, const KeyframeLocalizability& place);

/// Position of a keyframe for people: site coordinates where the map has them.
[[nodiscard]] Eigen::Vector3d shown_position(const MapView& map, std::uint32_t keyframe);

/// Shares of keyframes in each class, then the weak places with their numbers, positions and reasons.
[[nodiscard]] std::string format_places(const MapView& map, const std::vector<KeyframeLocalizability>& places,
                                        const std::vector<WeakPlace>& weak);

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
