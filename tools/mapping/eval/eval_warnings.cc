// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/common/text_format.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

using tools::text_of;

constexpr double kScaleTolerance = 0.01;

void warn_about_scale(const Evaluation& e, std::vector<std::string>* warnings) {
  const auto warn = [&](const std::optional<double>& scale, double tolerance, const char* how) {
    if (!scale || std::abs(*scale - 1) <= tolerance) return;
    warnings->push_back(
        text_of("SCALE: by %s the map would have to be multiplied by %.4f to fit the cloud; expected 1 +- %.2f. The "
                "distances above deceive",
                how, *scale, tolerance));
  };
  warn(e.scale, kScaleTolerance, "ICP");
  warn(e.points_scale, e.points_scale_tolerance, "the control points");
  warn(e.poses_scale, e.poses_scale_tolerance, "the camera positions");
  if (const double ratio = e.distances.volume_ratio(); ratio < 0.2 || ratio > 5) {
    warnings->push_back(
        text_of("VOLUME: the map's box is %.3g times the cloud's; either %s, or its scale is wrong. Control points would tell", ratio,
                ratio < 1 ? "it holds a small part of the scan" : "the scan holds a small part of the map"));
  }
}

/// Feet look like a building of three storeys; only where the map does not fit they are worth a word.
void warn_about_feet(const Evaluation& e, std::vector<std::string>* warnings) {
  const CloudDistances& d = e.distances;
  const double ratio = d.cloud_extent_m.minCoeff() / std::max(d.map_extent_m.minCoeff(), 0.1);
  const double share_outside = static_cast<double>(d.num_outside) / static_cast<double>(std::max<std::uint64_t>(1, e.num_used));
  if (!(ratio > 2.8 && ratio < 3.8 && (share_outside > 0.2 || d.plane.median_m > 0.05))) return;
  warnings->push_back(text_of(
      "UNIT: the cloud is %.1f times as high as the map, and the map does not fit; is the cloud in feet (--lidar-unit ft)?", ratio));
}

void warn_about_points(const Evaluation& e, std::vector<std::string>* warnings) {
  std::vector<double> sizes;
  for (const PointResidual& r : e.residuals) sizes.push_back(r.aligned_m.norm());
  if (sizes.empty()) return;
  const auto worst = std::max_element(sizes.begin(), sizes.end());
  const PointResidual& r = e.residuals[static_cast<std::size_t>(worst - sizes.begin())];
  if (*worst > std::max(0.05, 5 * r.sigma_m)) {
    warnings->push_back(text_of("POINTS: control point %s is off by %.3f m; check it for a typo or swapped axes", r.name.c_str(), *worst));
  }
}

void warn_about_alignment(const Evaluation& e, std::vector<std::string>* warnings) {
  if (e.search && !e.search->is_identity && e.search->rival_score_m < 1.25 * e.search->score_m) {
    warnings->push_back(
        text_of("START: found by search, and the building looks nearly as good from elsewhere (%.3f and %.3f m); give control "
                "points to be sure",
                e.search->score_m, e.search->rival_score_m));
  }
  const double share_outside = static_cast<double>(e.distances.num_outside) / static_cast<double>(std::max<std::uint64_t>(1, e.num_used));
  if (share_outside > 0.2) {
    warnings->push_back(
        text_of("OVERLAP: %.0f %% of the landmarks have no point of the cloud near; the alignment is wrong, or the scan lacks rooms",
                100 * share_outside));
  }
  if (!e.registration) return;
  if (e.start == AlignStart::kPoints && e.moved_m > 0.1) {
    warnings->push_back(text_of(
        "POINTS: the surfaces put the map %.2f m away from where the control points put it; which of the two is wrong?", e.moved_m));
  }
  if (e.registration->weakest_share < 0.01) {
    const Eigen::Vector3d& d = e.registration->weakest_direction;
    warnings->push_back(text_of("SLIDING: nearly no surface stands across (%.2f, %.2f, %.2f); the map may slide along there unnoticed",
                                d.x(), d.y(), d.z()));
  }
  if (!e.registration->is_converged) warnings->push_back("ICP: did not settle; the distances may improve with another start");
}

}  // namespace

std::vector<std::string> warnings_of(const Evaluation& evaluation) {
  std::vector<std::string> warnings;
  warn_about_scale(evaluation, &warnings);
  warn_about_feet(evaluation, &warnings);
  warn_about_points(evaluation, &warnings);
  warn_about_alignment(evaluation, &warnings);
  return warnings;
}

}  // namespace camloc::mapping
