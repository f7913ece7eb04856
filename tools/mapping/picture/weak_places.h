// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where in a map a fix is in doubt, said so that a person finds the place and knows what to do there.
#pragma once

#include <string>
#include <vector>

#include "core/map/map_view.h"
#include "core/mapmaking/localizability.h"

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

}  // namespace camloc::mapping
