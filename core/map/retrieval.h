// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which mapped views look like this image: visual words and an inverted file (Sivic and Zisserman, "Video Google", 2003)
// over the map's own vocabulary.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/features/hamming.h"
#include "core/map/map_view.h"
#include "core/registration/tfidf.h"

namespace camloc {

/// Not thread-safe; allocates at construction only. The map must outlive it.
class Retriever {
 public:
  /// Features of an image beyond `max_features` are ignored.
  Retriever(const MapView& map, int max_features);
  /// The `count` best keyframes, best first, fewer when fewer share a word. Scores are exact up to the 8 bits of the weights. The same
  /// features give the same bits. Valid until the next call.
  std::span<const RankedKeyframe> retrieve(std::span<const Descriptor> descriptors, int count);

 private:
  float accumulate_scores();

  const MapView* map_;
  std::vector<NearestDescriptor> nearest_;
  std::vector<float> idf_;                  ///< per word
  std::vector<std::uint32_t> word_counts_;  ///< per word: features of the image that fell on it
  std::vector<float> scores_;               ///< per keyframe
  std::vector<RankedKeyframe> ranked_;
};

}  // namespace camloc
