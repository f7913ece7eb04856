// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which earlier keyframes look like this frame, while the map still grows: visual words and an inverted file (Sivic and
// Zisserman, "Video Google", 2003). The words are trained from the keyframes themselves, and anew whenever their number has
// doubled, so that no vocabulary has to be shipped.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/registration/tfidf.h"

namespace camloc {

/// Not thread-safe. The same keyframes in the same order give the same bits.
class PlaceIndex {
 public:
  /// Keyframes are numbered in the order of these calls.
  void add(std::span<const Descriptor> descriptors);
  /// The `count` most alike, best first; ties by index. Empty before the first words are trained.
  [[nodiscard]] std::vector<RankedKeyframe> query(std::span<const Descriptor> descriptors, std::size_t count) const;

 private:
  struct Entry {
    std::uint32_t keyframe;
    float count;
  };
  void train();
  void enter(std::uint32_t keyframe);
  [[nodiscard]] std::vector<std::uint32_t> word_counts(std::span<const Descriptor> descriptors) const;

  std::vector<std::vector<Descriptor>> descriptors_;  ///< a sample of each keyframe's
  std::vector<Descriptor> words_;
  std::vector<std::vector<Entry>> entries_;  ///< per word
  std::size_t next_training_ = 8;
};

}  // namespace camloc
