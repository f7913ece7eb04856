// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Visual words trained from the map's own descriptors by k-majority: k-means in Hamming space whose centroids are bit-wise
// majorities (Grana, Borghesani, Manfredi, Cucchiara, "A fast approach for integrating ORB descriptors in the bag of words
// model", 2013), and the inverted file from words to keyframes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/map/map_data.h"

namespace camloc {

/// Words for a map with this many descriptors: one per 24, clamped to 64..2048, never more than descriptors.
[[nodiscard]] int default_num_words(std::size_t num_descriptors);

/// At most `num_words` words, all different. Deterministic; seeded by k-means++ (Arthur and Vassilvitskii, 2007).
[[nodiscard]] std::vector<Descriptor> train_vocabulary(std::span<const Descriptor> descriptors, int num_words, int max_iterations = 8);

/// Fills map.inverted_file from landmarks, keyframes and words. The weight of a word in a keyframe is its number of
/// descriptors there times its inverse document frequency; a keyframe's weights are scaled to an L2 norm of 255 and rounded
/// into 1..255.
void build_inverted_file(MapData* map);

}  // namespace camloc
