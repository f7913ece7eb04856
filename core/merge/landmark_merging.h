// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Landmarks of a map that was moved into the frame of another one become those of the other map where they are the same point:
// close to it in the views that see it, at its depth, and alike in appearance. A different appearance counts where the
// geometry agrees closely from the same side: it is what another day, with other light, adds to a landmark.
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_data.h"

namespace camloc {

struct LandmarkMergingOptions {
  double radius_px = 2.5;         ///< of level 0, grows with the level
  int max_distance = 64;          ///< of any two appearances
  double max_depth_sigmas = 3.0;  ///< tolerance along the optical axis
  double min_depth_tolerance_m = 0.02, max_depth_tolerance_m = 0.30;
  double max_reference_ratio = 2.0;  ///< between the ranges of reference distances
  // For a different appearance.
  double close_radius_px = 1.5;
  double close_depth_sigmas = 1.0, close_depth_tolerance_m = 0.015;
  double min_direction_cosine = 0.85;
  int max_different_distance = 96;  ///< of 256 bits; unrelated corners are 128 apart
  int appearance_distance = 48;     ///< a descriptor farther than this from all others is a further appearance
  std::size_t max_descriptors = 6;  ///< appearances a landmark may keep
};

/// Pairs of a landmark of `b`, already in the frame of `a`, and the landmark of `a` it is; each occurs once, ascending by b.
struct SameLandmark {
  std::uint32_t b = 0, a = 0;
  int distance = 0;  ///< of the closest two appearances
};
[[nodiscard]] std::vector<SameLandmark> find_same_landmarks(const MapData& a, const MapData& b, const LandmarkMergingOptions& options);

/// A landmark with the observations of both: position by information, widened ranges and cone of views. `support` says how many
/// observations stand behind each descriptor of `into`, on return those of the result, which come in that order. Returns how
/// many descriptors of `from` became further appearances.
std::uint32_t merge_landmark(const MapLandmark& from, const std::vector<std::uint32_t>& from_support, const LandmarkMergingOptions& options,
                             MapLandmark* into, std::vector<std::uint32_t>* support);

/// What a finished map no longer says: a guess at the observations behind each of a landmark's descriptors.
[[nodiscard]] std::vector<std::uint32_t> guess_support(const MapLandmark& landmark);

}  // namespace camloc
