// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of a few point pairs agree on one rigid motion: every triple of them is tried (Fischler and Bolles, "Random sample
// consensus", 1981; truncated squares as in Torr and Zisserman, "MLESAC", 2000), all triples where there are few points.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/alignment.h"

namespace camloc::mapping {

struct Consensus {
  std::vector<bool> is_inlier;  ///< as many as pairs; empty when no triple determines a motion
  std::size_t num_inliers = 0;
  double rms_m = 0;  ///< of the inliers
  /// Another choice of as few outliers explains the pairs about as well: which pair is wrong cannot be told.
  bool is_ambiguous = false;
  std::vector<bool> is_outlier_elsewhere;  ///< pairs that are outliers in one of those choices
};

/// A pair agrees when its residual is below max(4 sigmas, `tolerance_m`). Deterministic.
[[nodiscard]] Consensus find_consensus(std::span<const PointPair> pairs, double tolerance_m);

}  // namespace camloc::mapping
