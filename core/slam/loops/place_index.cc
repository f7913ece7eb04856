// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/slam/loops/place_index.h"

#include <algorithm>
#include <cmath>

#include "core/mapmaking/vocabulary.h"

namespace camloc {
namespace {

constexpr std::size_t kDescriptorsPerKeyframe = 400;  // evenly from all levels: enough for a histogram over words
constexpr std::size_t kMaxTrainingDescriptors = 30000;
constexpr int kMaxWords = 1024, kTrainingIterations = 4;

}  // namespace

void PlaceIndex::add(std::span<const Descriptor> descriptors) {
  auto& sample = descriptors_.emplace_back();
  const std::size_t step = descriptors.size() / kDescriptorsPerKeyframe + 1;
  for (std::size_t i = 0; i < descriptors.size(); i += step) sample.push_back(descriptors[i]);
  if (descriptors_.size() >= next_training_) {
    train();
  } else if (!words_.empty()) {
    enter(static_cast<std::uint32_t>(descriptors_.size() - 1));
  }
}

void PlaceIndex::train() {
  next_training_ = 2 * descriptors_.size();
  std::size_t total = 0;
  for (const auto& d : descriptors_) total += d.size();
  const std::size_t step = total / kMaxTrainingDescriptors + 1;
  std::vector<Descriptor> sample;
  std::size_t position = 0;
  for (const auto& of_keyframe : descriptors_) {
    for (const Descriptor& d : of_keyframe) {
      if (position++ % step == 0) sample.push_back(d);
    }
  }
  words_ = train_vocabulary(sample, std::min(default_num_words(sample.size()), kMaxWords), kTrainingIterations);
  entries_.assign(words_.size(), {});
  for (std::uint32_t k = 0; k < descriptors_.size(); ++k) enter(k);
}

std::vector<std::uint32_t> PlaceIndex::word_counts(std::span<const Descriptor> descriptors) const {
  std::vector<std::uint32_t> counts(words_.size());
  std::vector<NearestDescriptor> nearest(descriptors.size());
  count_words(descriptors, words_, nearest, counts);
  return counts;
}

void PlaceIndex::enter(std::uint32_t keyframe) {
  const std::vector<std::uint32_t> counts = word_counts(descriptors_[keyframe]);
  for (std::size_t w = 0; w < counts.size(); ++w) {
    if (counts[w] > 0) entries_[w].push_back({keyframe, static_cast<float>(counts[w])});
  }
}

std::vector<RankedKeyframe> PlaceIndex::query(std::span<const Descriptor> descriptors, std::size_t count) const {
  if (words_.empty() || descriptors.empty()) return {};
  const std::vector<std::uint32_t> counts = word_counts(descriptors);
  std::vector<float> scores(descriptors_.size(), 0), norm(descriptors_.size(), 0);
  float query_norm = 0;
  for (std::size_t w = 0; w < words_.size(); ++w) {
    if (entries_[w].empty()) continue;
    const auto idf = static_cast<float>(inverse_document_frequency(descriptors_.size(), entries_[w].size()));
    const float weight = static_cast<float>(counts[w]) * idf;
    query_norm += weight * weight;
    for (const Entry& e : entries_[w]) {
      scores[e.keyframe] += weight * e.count * idf;
      norm[e.keyframe] += e.count * e.count * idf * idf;
    }
  }
  for (std::size_t k = 0; k < scores.size(); ++k) {
    if (scores[k] > 0) scores[k] /= std::sqrt(norm[k] * query_norm);
  }
  std::vector<RankedKeyframe> ranked;
  ranked.resize(rank_keyframes(scores, static_cast<int>(count), &ranked).size());
  return ranked;
}

}  // namespace camloc
