// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/order_statistics.h"
#include "tools/common/text_format.h"
#include "tools/mapping/site/consensus.h"

namespace camloc::mapping {
namespace {

constexpr double kMaxTiltCosine = 0.87;  ///< 30 degrees: cameras look up and down
constexpr std::size_t kMaxPointsForScale = 200;

std::string axis_name(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return std::string(direction[axis] < 0 ? "-" : "+") + "xyz"[axis];
}

/// Median over all pairs of points of (distance in a) / (distance in b): a scale that a few wrong points do not move.
double median_scale(std::span<const PointPair> pairs) {
  std::vector<double> ratios;
  const std::size_t count = std::min(pairs.size(), kMaxPointsForScale);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      const double distance_b = (pairs[i].p_b - pairs[j].p_b).norm();
      if (distance_b > 0) ratios.push_back((pairs[i].p_a - pairs[j].p_a).norm() / distance_b);
    }
  }
  if (ratios.empty()) return 1;
  return upper_median(std::move(ratios));
}

struct Unit {
  double scale;  ///< numbers in the file over metres
  const char* name;
};
constexpr std::array<Unit, 4> kUnits = {{{1000, "millimetres"}, {100, "centimetres"}, {0.001, "kilometres"}, {3.28084, "feet"}}};

std::string describe_scale(double scale) {
  for (const Unit& unit : kUnits) {
    if (std::abs(scale / unit.scale - 1) > 0.03) continue;
    return std::string("when the file is taken as ") + unit.name;
  }
  return tools::text_of("when the file is divided by %.4g", scale);
}

std::string describe_mirror(const Alignment& swapped_fit, const std::optional<Eigen::Vector3d>& up_map) {
  if (!up_map) return "with two axes swapped or one of them turned over";
  const std::string up = axis_name(swapped_fit.T_a_b.rotation * *up_map);
  if (up == "+z") return "with x and y swapped (or one of them turned over)";
  if (up == "-z") return "with z turned over";
  if (up == "+y") return "with x and z swapped";
  if (up == "+x") return "with y and z swapped";
  return "with two axes swapped and one of them turned over";
}

double robust_residual_m(std::span<const PointPair> pairs) {
  const Alignment alignment = align_rigid(pairs);
  std::vector<double> residuals;
  for (const PointPair& pair : pairs) residuals.push_back((pair.p_a - alignment.map(pair.p_b)).norm());
  return upper_median(std::move(residuals));
}

}  // namespace

std::string explain_misfit(std::span<const PointPair> pairs, std::size_t num_agreeing, double tolerance_m,
                           const std::optional<Eigen::Vector3d>& up_map) {
  const double scale = median_scale(pairs);
  const bool is_scaled = scale > 0 && std::abs(std::log(scale)) > 0.05;
  for (const bool is_mirrored : {false, true}) {
    for (const bool is_rescaled : {false, true}) {
      if ((!is_mirrored && !is_rescaled) || (is_rescaled && !is_scaled)) continue;
      std::vector<PointPair> changed(pairs.begin(), pairs.end());
      for (PointPair& pair : changed) {
        if (is_mirrored) std::swap(pair.p_a.x(), pair.p_a.y());
        if (is_rescaled) pair.p_a /= scale;
      }
      const Consensus consensus = find_consensus(changed, tolerance_m);
      if (!consensus.has_majority() || consensus.num_inliers <= num_agreeing) continue;
      std::vector<PointPair> agreeing;
      for (std::size_t i = 0; i < changed.size(); ++i) {
        if (consensus.is_inlier[i]) agreeing.push_back(changed[i]);
      }
      std::string change;
      if (is_mirrored) change = describe_mirror(align_rigid(agreeing), up_map);
      if (is_rescaled) change += (change.empty() ? "" : " and ") + describe_scale(scale);
      return tools::text_of("the residuals drop from %.2f m to %.3f m %s: is the points file in another %s?", robust_residual_m(pairs),
                            consensus.rms_m, change.c_str(), is_mirrored ? (is_rescaled ? "axis order and unit" : "axis order") : "unit");
    }
  }
  return "";
}

std::string explain_upside_down(std::span<const PointPair> pairs, const Alignment& fit, const Eigen::Vector3d& up_map) {
  if (check_up(fit.T_a_b, up_map).empty()) return "";
  std::vector<PointPair> swapped(pairs.begin(), pairs.end());
  for (PointPair& pair : swapped) std::swap(pair.p_a.x(), pair.p_a.y());
  const Alignment mirrored = align_rigid(swapped);
  const bool fits_as_well = mirrored.rank == AlignmentRank::kFull && mirrored.chi_squared < 2 * fit.chi_squared + 25;
  if (!fits_as_well || !check_up(mirrored.T_a_b, up_map).empty()) return "";
  return "the points lie in a plane and fit with the map upside down; with x and y swapped they fit as well with up being up: is "
         "the points file in another axis order?";
}

std::string check_up(const Rigid3& T_wcs_map, const Eigen::Vector3d& up_map) {
  const Eigen::Vector3d up_wcs = T_wcs_map.rotation * up_map.normalized();
  if (up_wcs.z() > kMaxTiltCosine) return "";
  return "up in the map is " + axis_name(up_wcs) +
         " in the site coordinates, not +z: is the points file in another axis order? "
         "Poses will be given in its axes";
}

}  // namespace camloc::mapping
