// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/tfidf.h"

#include <algorithm>

namespace camloc {

void count_words(std::span<const Descriptor> descriptors, std::span<const Descriptor> words, std::span<NearestDescriptor> nearest,
                 std::span<std::uint32_t> counts) {
  std::fill(counts.begin(), counts.end(), 0U);
  nearest_descriptors(descriptors, words, nearest.data());
  for (std::size_t i = 0; i < descriptors.size(); ++i) ++counts[nearest[i].index];
}

std::span<const RankedKeyframe> rank_keyframes(std::span<const float> scores, int count, std::vector<RankedKeyframe>* ranked) {
  ranked->clear();
  for (std::uint32_t keyframe = 0; keyframe < scores.size(); ++keyframe) {
    if (scores[keyframe] > 0) ranked->push_back({keyframe, scores[keyframe]});
  }
  const std::size_t num_best = std::min(ranked->size(), static_cast<std::size_t>(std::max(0, count)));
  std::partial_sort(
      ranked->begin(), ranked->begin() + static_cast<std::ptrdiff_t>(num_best), ranked->end(),
      [](const RankedKeyframe& a, const RankedKeyframe& b) { return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe; });
  return std::span<const RankedKeyframe>(*ranked).first(num_best);
}

}  // namespace camloc
