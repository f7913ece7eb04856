// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which keyframes look alike, by visual words (Sivic and Zisserman, "Video Google", 2003): what a finished map and a map that still
// grows share. Words are visited in ascending order and ties go by index, so the scores are the same bits whatever the order of the
// features.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/features/hamming.h"

namespace camloc {

/// A keyframe that looks like a view.
struct RankedKeyframe {
  std::uint32_t keyframe = 0;
  float score = 0;  ///< cosine of the two tf-idf vectors
};

/// log(1 + keyframes / keyframes with the word): never zero, so that a word seen everywhere still counts a little.
[[nodiscard]] inline double inverse_document_frequency(std::size_t num_keyframes, std::size_t num_with_word) {
  return std::log(1.0 + static_cast<double>(num_keyframes) / static_cast<double>(num_with_word > 0 ? num_with_word : 1));
}

/// How often each word is the nearest one of a descriptor. `nearest` (at least as long as `descriptors`) is scratch.
void count_words(std::span<const Descriptor> descriptors, std::span<const Descriptor> words, std::span<NearestDescriptor> nearest,
                 std::span<std::uint32_t> counts);

/// The `count` best of those with a score above zero, best first. `ranked` has the capacity for all of them, then nothing is allocated.
[[nodiscard]] std::span<const RankedKeyframe> rank_keyframes(std::span<const float> scores, int count, std::vector<RankedKeyframe>* ranked);

}  // namespace camloc
