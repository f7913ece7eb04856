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

/// Pairs of a landmark of `b`, already in the frame of `a`, and the landmark of `a` it is; each occurs once, ascending by b.
struct SameLandmark {
  std::uint32_t b = 0, a = 0;
};
[[nodiscard]] std::vector<SameLandmark> find_same_landmarks(const MapData& a, const MapData& b);

/// A landmark with the observations of both: position by information, widened ranges and cone of views. `support` says how many
/// observations stand behind each descriptor of `into`, on return those of the result, which come in that order. Returns how
/// many descriptors of `from` became further appearances.
std::uint32_t merge_landmark(const MapLandmark& from, const std::vector<std::uint32_t>& from_support, MapLandmark* into,
                             std::vector<std::uint32_t>* support);

/// What a finished map no longer says: a guess at the observations behind each of a landmark's descriptors.
[[nodiscard]] std::vector<std::uint32_t> guess_support(const MapLandmark& landmark);

}  // namespace camloc
