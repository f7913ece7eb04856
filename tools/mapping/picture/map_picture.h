// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A sheet that shows a map: from above, in perspective, and where a fix is to be expected.
#pragma once

#include "core/io/image_file.h"
#include "tools/mapping/picture/map_scene.h"

namespace camloc::mapping {

enum class MapPanel { kTop, kPerspective, kCoverage, kAll };

/// Colours that keep apart for colour-blind readers (Okabe and Ito, "Color universal design", 2008) and in grey.
[[nodiscard]] Rgb color_of(FixOutlook outlook);

/// The sheet, `width_px` wide and as high as it needs. width_px from 400 to 8000.
[[nodiscard]] ColorImage draw_map(const MapPicture& picture, MapPanel panel, int width_px);

}  // namespace camloc::mapping
