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

namespace camloc {

struct RetrievedKeyframe {
  std::uint32_t keyframe = 0;
  float score = 0;  ///< larger is more alike
};

/// Not thread-safe; allocates at construction only.
class Retriever {
 public:
  Retriever(const MapView& map, int max_features);
  /// The `count` best keyframes, best first, fewer when fewer share a word; ties by keyframe index.
  std::span<const RetrievedKeyframe> retrieve(std::span<const Descriptor> descriptors, int count);

 private:
  const MapView* map_;
  std::vector<NearestDescriptor> nearest_;
  std::vector<float> scores_;
  std::vector<RetrievedKeyframe> ranked_;
};

}  // namespace camloc
