// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Triples are few, so all are tried. Every set of pairs that agrees with its own alignment is kept, not the best alone: another set of
// the same size that explains its pairs about as well means that nobody can tell which pair is wrong.
#include "tools/mapping/site/consensus.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxTriples = 5000;
constexpr double kMaxSigmas = 4;
constexpr int kMaxRefinements = 5;
/// A choice of outliers is taken for as good as the best one unless its squared residuals exceed that one's by this.
constexpr double kMinChiSquaredGap = 25, kMinChiSquaredRatio = 9;

using Mask = std::vector<bool>;
using Triple = std::array<std::size_t, 3>;

std::vector<Triple> triples_of(std::size_t count) {
  std::vector<Triple> triples;
  // 32 points have 4960 triples.
  if (count <= 32) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        for (std::size_t k = j + 1; k < count; ++k) triples.push_back({i, j, k});
      }
    }
    return triples;
  }
  std::mt19937 random(1);
  while (triples.size() < kMaxTriples) {
    const Triple triple = {random() % count, random() % count, random() % count};
    if (triple[0] != triple[1] && triple[0] != triple[2] && triple[1] != triple[2]) triples.push_back(triple);
  }
  return triples;
}

/// A set of pairs that agree with their own alignment.
struct Choice {
  double cost = 0;         ///< sum of truncated squares, 1 for an outlier
  double chi_squared = 0;  ///< of the inliers
  double rms_m = 0;
  std::size_t num_inliers = 0;
};

class Search {
 public:
  Search(std::span<const PointPair> pairs, double tolerance_m) : pairs_(pairs) {
    for (const PointPair& pair : pairs) limits_m_.push_back(std::max(kMaxSigmas * pair.sigma_m, tolerance_m));
  }

  void try_triple(const Triple& triple) {
    Mask mask(pairs_.size(), false);
    for (const std::size_t i : triple) mask[i] = true;
    Alignment alignment = align(mask);
    for (int i = 0; i < kMaxRefinements && alignment.rank == AlignmentRank::kFull; ++i) {
      const Mask agreeing = agreeing_with(alignment);
      if (std::count(agreeing.begin(), agreeing.end(), true) < 3) return;
      if (agreeing == mask && i > 0) return keep(mask, alignment);
      mask = agreeing;
      alignment = align(mask);
    }
  }

  [[nodiscard]] Consensus result() const {
    Consensus consensus;
    if (choices_.empty()) return consensus;
    const auto best =
        std::min_element(choices_.begin(), choices_.end(), [](const auto& a, const auto& b) { return a.second.cost < b.second.cost; });
    consensus.is_inlier = best->first;
    consensus.num_inliers = best->second.num_inliers;
    consensus.rms_m = best->second.rms_m;
    consensus.is_outlier_elsewhere.assign(pairs_.size(), false);
    const double limit = kMinChiSquaredGap + kMinChiSquaredRatio * best->second.chi_squared;
    for (const auto& [mask, choice] : choices_) {
      if (mask == best->first || choice.num_inliers < best->second.num_inliers || choice.chi_squared > limit) continue;
      consensus.is_ambiguous = true;
      for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!mask[i]) consensus.is_outlier_elsewhere[i] = true;
      }
    }
    return consensus;
  }

 private:
  [[nodiscard]] Alignment align(const Mask& mask) {
    chosen_.clear();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (mask[i]) chosen_.push_back(pairs_[i]);
    }
    return align_rigid(chosen_);
  }

  [[nodiscard]] Mask agreeing_with(const Alignment& alignment) const {
    Mask mask(pairs_.size());
    for (std::size_t i = 0; i < pairs_.size(); ++i) mask[i] = residual_m(alignment, i) <= limits_m_[i];
    return mask;
  }

  [[nodiscard]] double residual_m(const Alignment& alignment, std::size_t i) const {
    return (pairs_[i].p_a - alignment.map(pairs_[i].p_b)).norm();
  }

  void keep(const Mask& mask, const Alignment& alignment) {
    Choice choice{0, alignment.chi_squared, alignment.rms_m, 0};
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      choice.num_inliers += mask[i] ? 1 : 0;
      const double ratio = residual_m(alignment, i) / limits_m_[i];
      choice.cost += mask[i] ? ratio * ratio : 1;
    }
    choices_.emplace(mask, choice);
  }

  std::span<const PointPair> pairs_;
  std::vector<double> limits_m_;
  std::vector<PointPair> chosen_;
  std::map<Mask, Choice> choices_;
};

}  // namespace

Consensus find_consensus(std::span<const PointPair> pairs, double tolerance_m) {
  Search search(pairs, tolerance_m);
  for (const Triple& triple : triples_of(pairs.size())) search.try_triple(triple);
  return search.result();
}

}  // namespace camloc::mapping
