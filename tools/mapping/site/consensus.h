// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of a few point pairs agree on one rigid motion: every triple of them is tried (Fischler and Bolles, "Random sample
// consensus", 1981; truncated squares as in Torr and Zisserman, "MLESAC", 2000), all triples where there are few points.
// When they fit none as they are: would they with other axes or in other units (axis_check.cc)?
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/alignment.h"

namespace camloc::mapping {

struct Consensus {
  std::vector<bool> is_inlier;  ///< as many as pairs; empty when no triple determines a motion
  std::size_t num_inliers = 0;
  double rms_m = 0;  ///< of the inliers
  [[nodiscard]] bool has_majority() const { return num_inliers >= 3 && 2 * num_inliers > is_inlier.size(); }
  /// Another choice of as few outliers explains the pairs about as well: which pair is wrong cannot be told.
  bool is_ambiguous = false;
  std::vector<bool> is_outlier_elsewhere;  ///< pairs that are outliers in one of those choices
};

/// A pair agrees when its residual is below max(4 sigmas, `tolerance_m`). Deterministic.
[[nodiscard]] Consensus find_consensus(std::span<const PointPair> pairs, double tolerance_m);

/// A sentence such as "the residuals drop from 3.20 m to 0.02 m with x and y swapped: ..."; empty where nothing helps,
/// that is where no change makes more pairs agree than the `num_agreeing` that do without one.
/// A mirror image is one whichever axis is turned over, and any order of axes is a rotation of it: `up_map` (in the map,
/// rough) says which one it was, as long as z of the site is up.
[[nodiscard]] std::string explain_misfit(std::span<const PointPair> pairs, std::size_t num_agreeing, double tolerance_m,
                                         const std::optional<Eigen::Vector3d>& up_map);

/// Points in a plane fit their mirror image just as well, upside down: a sentence where that is what happened, else empty.
[[nodiscard]] std::string explain_upside_down(std::span<const PointPair> pairs, const Alignment& fit, const Eigen::Vector3d& up_map);

/// A warning where the fitted site has its z axis not up; empty where it is.
[[nodiscard]] std::string check_up(const Rigid3& T_wcs_map, const Eigen::Vector3d& up_map);

}  // namespace camloc::mapping
