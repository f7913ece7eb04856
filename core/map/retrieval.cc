// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Each feature votes for its nearest word; each word with votes adds to the keyframes that contain it. Words are visited
// in ascending order, so the sums are the same bits whatever the order of the features.
#include "core/map/retrieval.h"

#include <algorithm>
#include <cmath>

namespace camloc {

Retriever::Retriever(const MapView& map, int max_features)
    : map_(&map),
      nearest_(static_cast<std::size_t>(std::max(0, max_features))),
      idf_(map.info().num_words),
      word_counts_(map.info().num_words),
      scores_(map.info().num_keyframes) {
  ranked_.reserve(scores_.size());
  for (std::uint32_t word = 0; word < idf_.size(); ++word) idf_[word] = map.word_idf(word);
}

std::span<const RankedKeyframe> Retriever::retrieve(std::span<const Descriptor> descriptors, int count) {
  if (word_counts_.empty() || count <= 0) return {};
  count_words(descriptors.first(std::min(descriptors.size(), nearest_.size())), map_->words(), nearest_, word_counts_);
  const float squared_norm = accumulate_scores();
  if (!(squared_norm > 0)) return {};
  const float scale = 1.0F / (255.0F * std::sqrt(squared_norm));
  for (float& score : scores_) score *= scale;
  return rank_keyframes(scores_, count, &ranked_);
}

/// Fills scores_ with the inner products and returns the squared norm of the image's vector.
float Retriever::accumulate_scores() {
  std::fill(scores_.begin(), scores_.end(), 0.0F);
  float squared_norm = 0;
  for (std::uint32_t word = 0; word < word_counts_.size(); ++word) {
    if (word_counts_[word] == 0) continue;
    const float weight = static_cast<float>(word_counts_[word]) * idf_[word];
    squared_norm += weight * weight;
    const auto keyframes = map_->word_keyframes(word);
    const auto weights = map_->word_weights(word);
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      // Valid since open; the test is for a file that was overwritten while mapped.
      if (keyframes[i] < scores_.size()) scores_[keyframes[i]] += weight * static_cast<float>(weights[i]);
    }
  }
  return squared_norm;
}

}  // namespace camloc
