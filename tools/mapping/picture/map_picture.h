// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A sheet that shows a map: from above, in perspective, and where a fix is to be expected.
#pragma once

#include <string>
#include <vector>

#include "core/io/image_file.h"
#include "core/map/map_view.h"
#include "core/mapmaking/localizability.h"
#include "tools/mapping/picture/point_raster.h"
#include "tools/mapping/picture/weak_places.h"

namespace camloc::mapping {

enum class MapPanel { kTop, kPerspective, kCoverage, kAll };

struct MapPicture {
  const MapView* map = nullptr;
  std::vector<KeyframeLocalizability> places;  ///< one a keyframe
  std::vector<WeakPlace> weak;                 ///< numbered in the picture from 1
  std::vector<Rigid3> trajectory;              ///< T_map_camera in order; may be empty
};

/// Colours that keep apart for colour-blind readers (Okabe and Ito, "Color universal design", 2008) and in grey.
[[nodiscard]] Rgb color_of(FixOutlook outlook);

/// The sheet, `width_px` wide and as high as it needs. width_px from 400 to 8000.
[[nodiscard]] ColorImage draw_map(const MapPicture& picture, MapPanel panel, int width_px);

}  // namespace camloc::mapping
