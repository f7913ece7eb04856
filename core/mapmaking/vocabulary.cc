// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Seeds far from each other (draw_seeds), then rounds of: each descriptor to its nearest word, each word to the bit-wise
// majority of its descriptors. The inverted file counts the words of each keyframe's landmarks and weighs them by tf-idf.
#include "core/mapmaking/vocabulary.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/base/mix_bits.h"
#include "core/features/hamming.h"
#include "core/registration/tfidf.h"

namespace camloc {
namespace {

// Each further seed is drawn with a probability proportional to its squared distance to the nearest seed so far. Integers
// throughout: the sum of the squares fits easily (256^2 times 2^40 descriptors).
std::vector<Descriptor> draw_seeds(std::span<const Descriptor> descriptors, std::size_t num_words) {
  std::uint64_t state = 0x63616D6C6F63;
  const auto draw = [&state] { return mix_bits(std::exchange(state, state + 0x9E3779B97F4A7C15U)); };  // SplitMix64
  std::vector<Descriptor> seeds{descriptors[draw() % descriptors.size()]};
  std::vector<std::uint16_t> nearest(descriptors.size(), 257), distance(descriptors.size());
  while (seeds.size() < num_words) {
    hamming_distances(seeds.back(), descriptors, distance.data());
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      nearest[i] = std::min(nearest[i], distance[i]);
      total += static_cast<std::uint64_t>(nearest[i]) * nearest[i];
    }
    if (total == 0) break;  // fewer different descriptors than words
    std::uint64_t mark = draw() % total;
    std::size_t chosen = 0;
    for (;; ++chosen) {
      const std::uint64_t weight = static_cast<std::uint64_t>(nearest[chosen]) * nearest[chosen];
      if (mark < weight) break;
      mark -= weight;
    }
    seeds.push_back(descriptors[chosen]);
  }
  return seeds;
}

/// Bit k of the index as a one in byte k.
constexpr std::array<std::uint64_t, 256> kSpreadBits = [] {
  std::array<std::uint64_t, 256> spread{};
  for (std::size_t byte = 0; byte < 256; ++byte) {
    for (std::size_t bit = 0; bit < 8; ++bit) spread[byte] |= static_cast<std::uint64_t>(byte >> bit & 1U) << (8 * bit);
  }
  return spread;
}();

/// How many of a set of descriptors have each bit. Counts in bytes, eight at a time, until one could overflow.
class BitCounts {
 public:
  void add(const Descriptor& descriptor) {
    for (std::size_t byte = 0; byte < small_.size(); ++byte)
      small_[byte] += kSpreadBits[descriptor.bits[byte / 8] >> (8 * (byte % 8)) & 0xFFU];
    ++num_;
    if (num_ % 255 == 0) carry();
  }
  /// Bit-wise majority; where there is a tie, or no descriptor at all, the bits of `otherwise`.
  Descriptor majority(const Descriptor& otherwise) {
    carry();
    Descriptor result = otherwise;
    for (std::size_t bit = 0; bit < large_.size(); ++bit) {
      const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
      if (2 * large_[bit] > num_) result.bits[bit / 64] |= mask;
      if (2 * large_[bit] < num_) result.bits[bit / 64] &= ~mask;
    }
    return result;
  }

 private:
  void carry() {
    for (std::size_t bit = 0; bit < large_.size(); ++bit) large_[bit] += small_[bit / 8] >> (8 * (bit % 8)) & 0xFFU;
    small_.fill(0);
  }
  std::array<std::uint64_t, 32> small_{};
  std::array<std::uint64_t, 256> large_{};
  std::uint64_t num_ = 0;
};

// Centres of the clusters.
void move_to_majority(std::span<const Descriptor> descriptors, std::span<const NearestDescriptor> nearest, std::vector<Descriptor>* words) {
  std::vector<BitCounts> counts(words->size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) counts[nearest[i].index].add(descriptors[i]);
  for (std::size_t w = 0; w < words->size(); ++w) (*words)[w] = counts[w].majority((*words)[w]);
}

void remove_duplicates(std::vector<Descriptor>* words) {
  std::set<std::array<std::uint64_t, 4>> different;
  for (const Descriptor& word : *words) different.insert(word.bits);
  words->clear();
  for (const auto& bits : different) words->push_back({bits});
}

}  // namespace

int default_num_words(std::size_t num_descriptors) {
  const std::size_t words = std::clamp<std::size_t>(num_descriptors / 24, 64, 2048);
  return static_cast<int>(std::min(words, num_descriptors));
}

std::vector<Descriptor> train_vocabulary(std::span<const Descriptor> descriptors, int num_words, int max_iterations) {
  if (descriptors.empty() || num_words <= 0) return {};
  std::vector<Descriptor> words = draw_seeds(descriptors, std::min(static_cast<std::size_t>(num_words), descriptors.size()));
  std::vector<NearestDescriptor> nearest(descriptors.size());
  std::uint64_t last_total = ~std::uint64_t{0};
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    nearest_descriptors(descriptors, words, nearest.data());
    std::uint64_t total = 0;
    for (const NearestDescriptor& n : nearest) total += n.distance;
    if (total >= last_total) break;
    last_total = total;
    move_to_majority(descriptors, nearest, &words);
  }
  remove_duplicates(&words);
  return words;
}

void build_inverted_file(MapData* map) {
  assert(map->keyframes.size() <= 65536);
  map->inverted_file.assign(map->words.size(), {});
  if (map->words.empty()) return;
  std::vector<Descriptor> descriptors;
  std::vector<std::size_t> first;
  for (const MapLandmark& landmark : map->landmarks) {
    first.push_back(descriptors.size());
    descriptors.insert(descriptors.end(), landmark.descriptors.begin(), landmark.descriptors.end());
  }
  first.push_back(descriptors.size());
  std::vector<NearestDescriptor> nearest(descriptors.size());
  nearest_descriptors(descriptors, map->words, nearest.data());

  std::vector<std::map<std::uint32_t, double>> frequency(map->keyframes.size());  // word -> number of descriptors
  std::vector<std::size_t> num_with_word(map->words.size(), 0);
  for (std::size_t k = 0; k < map->keyframes.size(); ++k) {
    for (const std::uint32_t landmark : map->keyframes[k].landmarks) {
      for (std::size_t d = first[landmark]; d < first[landmark + 1]; ++d) frequency[k][nearest[d].index] += 1.0;
    }
    for (const auto& entry : frequency[k]) ++num_with_word[entry.first];
  }
  for (std::size_t k = 0; k < map->keyframes.size(); ++k) {
    double sum_squared = 0;
    for (auto& [word, weight] : frequency[k]) {
      weight *= inverse_document_frequency(map->keyframes.size(), num_with_word[word]);
      sum_squared += weight * weight;
    }
    for (const auto& [word, weight] : frequency[k]) {
      const long scaled = std::lround(255.0 * weight / std::sqrt(sum_squared));
      map->inverted_file[word].push_back({static_cast<std::uint16_t>(k), static_cast<std::uint8_t>(std::clamp(scaled, 1L, 255L))});
    }
  }
}

}  // namespace camloc
