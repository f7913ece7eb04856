// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Matching by descriptor alone. One pass of the nearest-neighbour kernel finds the best and the second best candidate of
// every feature; only where both belong to one landmark, and the ratio test is on, are all distances of the feature looked
// at again for the rival.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/features/hamming_kernels.h"
#include "core/features/matcher.h"

namespace camloc {
namespace {

constexpr std::uint16_t kNoDistance = 257;
constexpr std::int32_t kNotComputed = -2;
constexpr double kTwoPi = 2 * std::numbers::pi;

/// Angle in [0, 2 pi); anything that is not finite gives 0.
double wrapped(double angle_rad) {
  const double turns = angle_rad / kTwoPi;
  const double fraction = turns - std::floor(turns);
  return fraction >= 0 && fraction < 1 ? fraction * kTwoPi : 0;
}

/// Circular mean around the fullest three neighbouring bins of the histogram. Peaks of equal height: the first.
double dominant_angle(std::span<const double> angles_rad) {
  constexpr int kBins = 30;
  std::array<int, kBins> count{};
  const auto bin_of = [](double angle) { return std::min(kBins - 1, static_cast<int>(angle * (kBins / kTwoPi))); };
  for (const double angle : angles_rad) ++count[static_cast<std::size_t>(bin_of(angle))];
  int peak = 0, peak_count = -1;
  for (int bin = 0; bin < kBins; ++bin) {
    int sum = 0;
    for (int offset = kBins - 1; offset <= kBins + 1; ++offset) sum += count[static_cast<std::size_t>((bin + offset) % kBins)];
    // The middle bin decides between neighbours that share the same peak.
    const int score = 4 * sum + count[static_cast<std::size_t>(bin)];
    if (score > peak_count) peak = bin, peak_count = score;
  }
  const double centre = (peak + 0.5) * (kTwoPi / kBins);
  double sum = 0;
  int members = 0;
  for (const double angle : angles_rad) {
    const double deviation = std::remainder(angle - centre, kTwoPi);
    if (std::abs(deviation) <= 1.5 * (kTwoPi / kBins)) sum += deviation, ++members;
  }
  return members > 0 ? centre + sum / members : 0;
}

}  // namespace

CandidateSet::CandidateSet(std::size_t capacity) : descriptors(capacity), landmarks(capacity), angles_rad(capacity) {}

bool CandidateSet::add(const Descriptor& descriptor, std::int32_t landmark, float angle_rad) {
  if (size >= descriptors.size()) return false;
  descriptors[size] = descriptor;
  landmarks[size] = landmark;
  angles_rad[size] = angle_rad;
  ++size;
  return true;
}

CandidateMatcher::CandidateMatcher(const CandidateMatcherOptions& options, int max_features, std::size_t max_candidates)
    : options_(options),
      distances_(std::max(static_cast<std::size_t>(max_features), max_candidates)),
      first_in_slot_(std::bit_ceil(2 * max_candidates + 2)),
      next_candidate_(max_candidates),
      best_feature_in_slot_(first_in_slot_.size()),
      max_features_(static_cast<std::size_t>(max_features)),
      max_candidates_(max_candidates) {
  matches_.reserve(max_features_);
  candidate_.reserve(max_features_);
  rotations_rad_.reserve(max_features_);
}

std::span<const Match> CandidateMatcher::match(const Features& features, const CandidateSet& candidates) {
  assert(candidates.size <= max_candidates_);
  matches_.clear();
  candidate_.clear();
  index_landmarks(candidates);
  find_best_candidates(features, candidates, std::min(features.size(), max_features_));
  if (options_.is_mutual) keep_mutual(features, candidates);
  if (options_.max_rotation_deviation_rad > 0) keep_dominant_rotation(features, candidates);
  return matches_;
}

void CandidateMatcher::find_best_candidates(const Features& features, const CandidateSet& candidates, std::size_t num_features) {
  const hamming::Kernels& kernels = hamming::best_kernels();
  const bool has_ratio_test = options_.max_ratio < 1;
  std::array<hamming::TopTwo, hamming::kMaxQueriesPerCall> top;
  for (std::size_t begin = 0; begin < num_features; begin += top.size()) {
    const std::size_t count = std::min(top.size(), num_features - begin);
    hamming::nearest_two(kernels, features.descriptors.data() + begin, count, candidates.descriptors.data(), candidates.size, top.data());
    for (std::size_t q = 0; q < count; ++q) {
      const auto distance = static_cast<std::uint16_t>(top[q].best >> 32);
      if (distance > options_.max_distance || distance >= kNoDistance) continue;
      const auto best = static_cast<std::uint32_t>(top[q].best), second = static_cast<std::uint32_t>(top[q].second);
      const std::int32_t landmark = candidates.landmarks[best];
      auto rival = static_cast<std::uint16_t>(top[q].second >> 32);
      // Without the ratio test nobody needs the rival enough to pay for a guided refinement at all candidates.
      if (rival < kNoDistance && candidates.landmarks[second] == landmark)
        rival = has_ratio_test ? rival_distance(features.descriptors[begin + q], candidates, landmark) : kNoDistance;
      if (has_ratio_test && distance > options_.max_ratio * rival) continue;
      matches_.push_back({static_cast<std::int32_t>(begin + q), landmark, distance, rival});
      candidate_.push_back(best);
    }
  }
}

std::uint16_t CandidateMatcher::rival_distance(const Descriptor& descriptor, const CandidateSet& candidates, std::int32_t landmark) {
  hamming_distances(descriptor, {candidates.descriptors.data(), candidates.size}, distances_.data());
  // Strike the landmark's own appearances out, then take the plain minimum.
  for (std::int32_t i = first_in_slot_[slot_of(candidates, landmark)]; i >= 0; i = next_candidate_[static_cast<std::size_t>(i)])
    distances_[static_cast<std::size_t>(i)] = kNoDistance;
  return hamming::smallest(distances_.data(), candidates.size);
}

/// Slot of a landmark that is among the candidates, or the empty slot where it belongs.
std::size_t CandidateMatcher::slot_of(const CandidateSet& candidates, std::int32_t landmark) const {
  const std::size_t mask = first_in_slot_.size() - 1;
  // Multiplicative hashing (Knuth); the table is at most half full, so there is always an empty slot.
  std::size_t slot = (static_cast<std::uint32_t>(landmark) * std::uint64_t{0x9e3779b97f4a7c15} >> 32) & mask;
  while (first_in_slot_[slot] >= 0 && candidates.landmarks[static_cast<std::size_t>(first_in_slot_[slot])] != landmark)
    slot = (slot + 1) & mask;
  return slot;
}

void CandidateMatcher::index_landmarks(const CandidateSet& candidates) {
  std::fill(first_in_slot_.begin(), first_in_slot_.end(), -1);
  std::fill(best_feature_in_slot_.begin(), best_feature_in_slot_.end(), kNotComputed);
  for (std::size_t i = 0; i < candidates.size; ++i) {
    const std::size_t slot = slot_of(candidates, candidates.landmarks[i]);
    next_candidate_[i] = first_in_slot_[slot];
    first_in_slot_[slot] = static_cast<std::int32_t>(i);
  }
}

/// Feature closest to any appearance of the slot's landmark; equal distances: the first feature.
std::int32_t CandidateMatcher::best_feature_of(std::size_t slot, const Features& features, const CandidateSet& candidates) {
  if (best_feature_in_slot_[slot] != kNotComputed) return best_feature_in_slot_[slot];
  const std::size_t num_features = std::min(features.size(), max_features_);
  std::uint16_t best_distance = kNoDistance;
  std::int32_t best = -1;
  for (std::int32_t candidate = first_in_slot_[slot]; candidate >= 0; candidate = next_candidate_[static_cast<std::size_t>(candidate)]) {
    hamming_distances(candidates.descriptors[static_cast<std::size_t>(candidate)], {features.descriptors.data(), num_features},
                      distances_.data());
    const std::uint16_t distance = hamming::smallest(distances_.data(), num_features);
    if (distance > best_distance) continue;
    const auto feature = static_cast<std::int32_t>(std::find(distances_.begin(), distances_.end(), distance) - distances_.begin());
    if (distance < best_distance || feature < best) best_distance = distance, best = feature;
  }
  return best_feature_in_slot_[slot] = best;
}

void CandidateMatcher::keep_mutual(const Features& features, const CandidateSet& candidates) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    const std::size_t slot = slot_of(candidates, matches_[i].landmark);
    if (best_feature_of(slot, features, candidates) != matches_[i].feature) continue;
    matches_[kept] = matches_[i];
    candidate_[kept++] = candidate_[i];
  }
  matches_.resize(kept);
  candidate_.resize(kept);
}

void CandidateMatcher::keep_dominant_rotation(const Features& features, const CandidateSet& candidates) {
  rotations_rad_.clear();
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    const double seen = features.keypoints[static_cast<std::size_t>(matches_[i].feature)].angle_rad;
    rotations_rad_.push_back(wrapped(seen - candidates.angles_rad[candidate_[i]]));
  }
  const double dominant = dominant_angle(rotations_rad_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < matches_.size(); ++i)
    if (std::abs(std::remainder(rotations_rad_[i] - dominant, kTwoPi)) <= options_.max_rotation_deviation_rad)
      matches_[kept++] = matches_[i];
  matches_.resize(kept);
}

}  // namespace camloc
