// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From landmarks and who saw them to a map: the most useful landmarks and descriptors within the byte budget, the fewest
// keyframes that cover them, words. Building and merging maps end here.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/features/orb_extractor.h"
#include "core/map/map_data.h"
#include "core/mapmaking/landmark_fusion.h"

namespace camloc {

struct MapBuildOptions {
  OrbOptions orb;
  std::uint64_t max_bytes = 0;  ///< of the file; 0 = no limit
  double appearance_share = 0;  ///< of the file, set aside for further descriptors; without max_bytes any > 0 keeps them all
  bool fills_budget = false;    ///< choose again, more landmarks, where the first choice leaves much of max_bytes
};

struct MapBuildReport {
  std::uint32_t num_frames = 0;
  std::uint64_t num_observations = 0;
  std::uint32_t num_landmarks_before = 0, num_landmarks = 0;  ///< before and after pruning and the byte budget
  std::uint32_t num_keyframes_before = 0, num_keyframes = 0;  ///< views with landmarks, and the set that covers them all
  std::uint32_t num_descriptors = 0, num_words = 0;
  std::uint64_t file_bytes = 0;
  std::uint32_t num_consistency_pairs = 0;  ///< pairs of views behind MapData::pose_sigma_m and pose_sigma_rad
};

/// What a map is made of. Views and poses have the same length.
struct MapParts {
  RgbdCamera camera;
  double pose_sigma_m = 0, pose_sigma_rad = 0;          ///< see MapData
  std::vector<MapLandmark> landmarks;                   ///< descriptors ordered by support
  std::vector<std::vector<std::uint32_t>> support;      ///< observations behind each of their descriptors
  std::span<const std::vector<ViewObservation>> views;  ///< a landmark at most once a view
  std::span<const Rigid3> poses;                        ///< T_map_camera of each view
  /// How many frames would see each landmark again; empty: as many as the views that saw it.
  std::vector<float> worth;
};

/// Fills the report's counts of landmarks, keyframes, descriptors, words and bytes; `report` may be null. Without name and datum.
/// Errors: kInvalid when no landmark is left or the budget is too small, kUnsupported for more keyframes than a map can name.
[[nodiscard]] Result<MapData> assemble_map(const MapParts& parts, const MapBuildOptions& options, MapBuildReport* report);

}  // namespace camloc
