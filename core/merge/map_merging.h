// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two maps of one building become one: a second day, or the next floor. Read merge_maps: the second map is localized in the
// first, bent onto it, its landmarks become those of the first where they are the same point, and what is most useful of both
// is kept within the budget. The first map's frame and poses stay as they are.
#pragma once

#include <cstdint>

#include "core/mapmaking/map_assembly.h"
#include "core/merge/landmark_merging.h"
#include "core/merge/map_alignment.h"
#include "core/merge/map_registration.h"

namespace camloc {

/// What a merged map spends its bytes on. Measured on a generated building of corridors and offices: of 354 single frames of the
/// second day, held out, localized in a map of as many bytes of
///            the first day   both days, as seen   what both days saw twice as useful   and 5 % for further appearances
///   1 MB     262             256                  274                                 274
///   3 MB     276             289                  289                                 290
///   8 MB     281             292                  -                                   294
/// More than 5 % changes nothing: few landmarks look different enough, 1.2 descriptors a landmark are all there is.
[[nodiscard]] inline MapBuildOptions merged_map_options() {
  MapBuildOptions options;
  options.appearance_share = 0.05;
  options.fills_budget = true;
  return options;
}

struct MapMergeOptions {
  MapBuildOptions map = merged_map_options();  ///< its ORB settings are taken from the maps
};

struct MapMergeReport {
  std::uint32_t num_keyframes_a = 0, num_keyframes_b = 0, num_landmarks_a = 0, num_landmarks_b = 0;
  MapRegistrationReport registration;
  std::uint32_t num_localized = 0;  ///< keyframes of B found in A
  MapAlignmentReport alignment;
  std::uint32_t num_fused = 0;        ///< landmarks of B that became one of A
  std::uint32_t num_added = 0;        ///< landmarks of B that are new; both before the budget
  std::uint32_t num_appearances = 0;  ///< descriptors that fused landmarks gained, before the budget
  bool is_datum_from_b = false;
  MapBuildReport map;  ///< what was kept
};

/// `b` is a map without words or with; only its camera, landmarks, keyframes and datum count. The result has the name, the camera
/// and the frame of `a`, and its datum; only where it has none that of `b`, carried over.
/// Errors: kInvalid when the maps do not fit (other pyramid, quite another focal length, no place in common) or nothing fits the
/// budget; kUnavailable when `observer` said so. The same maps and options give the same bytes.
[[nodiscard]] Result<MapData> merge_maps(const MapView& a, const MapData& b, const MapMergeOptions& options, WorkObserver& observer,
                                         MapMergeReport* report);

}  // namespace camloc
