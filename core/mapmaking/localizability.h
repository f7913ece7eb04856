// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How well a camera would be localized where a map was made, from the map alone: every keyframe is asked as if it were a query
// made of its own landmarks. Expected precision comes from the information matrix of reprojection and depth; look-alike places
// from retrieval, descriptors, and the pose that the other place would explain them with (what a false fix is made of).
// It says nothing about places that no keyframe saw, and nothing about change since.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/map_view.h"
#include "core/mapmaking/rival_search.h"

namespace camloc {

enum class FixOutlook : std::uint8_t {
  kLikely,     ///< a fix is likely
  kLookAlike,  ///< another place of the map explains this view nearly as well: a fix may be refused, at worst be wrong
  kScanAgain,  ///< too little in the map for a fix
};

/// Why a place should be scanned again.
enum class FixWeakness : std::uint8_t { kNone, kFewLandmarks, kPoorSpread, kImprecise };

/// The limits were set where single frames of another day stopped being fixed in a generated building of corridors and offices
/// (887 frames, 1851 keyframes): 90 % of the frames were fixed where the keyframe with the nearest view has less than 40 rival
/// inliers, 78 % from 40, 52 % from 60, 32 % from 100; none of 13 where it has fewer than 150 landmarks, 1 of 18 where they fill less
/// than 0.2 of the image, 19 of 29 up to 0.4, 94 % above.
struct LocalizabilityOptions {
  std::uint32_t min_observations = 2;  ///< frames that must have seen a landmark for a query to see it, too
  double repeatability = 0.2;          ///< share of those that a query of another day finds again and matches
  std::uint32_t min_landmarks = 100;   ///< a fifth of them found again are the 20 inliers that the localizer asks for
  double min_spread = 0.25;            ///< of the image's cells that hold one
  double max_position_sigma_m = 0.05;  ///< expected, largest axis

  RivalSearchOptions rivals{};
  /// From here on a place looks alike: that many matches agree on one pose there (by chance up to 6), or this share of the
  /// descriptors matches (rooms of one building have up to 0.08 by chance, bays of one corridor 0.1 to 0.45).
  std::uint32_t min_rival_inliers = 40;
  double min_rival_share = 0.25;
};

struct KeyframeLocalizability {
  FixOutlook outlook = FixOutlook::kLikely;
  FixWeakness weakness = FixWeakness::kNone;  ///< set with kScanAgain
  std::uint32_t num_landmarks = 0;            ///< of the keyframe that other frames saw, too
  double spread = 0;                          ///< share of the image's 8 x 6 cells that hold one
  double position_sigma_m = 0;                ///< expected, of the worst axis; infinite where the view does not fix the pose
  double rotation_sigma_rad = 0;
  std::optional<RivalPlace> rival;  ///< the most similar other place, look-alike or not
};

/// One entry a keyframe. A weak place is kScanAgain even where it looks like another one as well. The same map gives the same bits.
[[nodiscard]] std::vector<KeyframeLocalizability> assess_localizability(const MapView& map, const LocalizabilityOptions& options = {});

}  // namespace camloc
