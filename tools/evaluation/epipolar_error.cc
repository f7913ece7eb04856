// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/epipolar_error.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace camloc::tools {
namespace {

constexpr double kMetresPerRadian = 2.0;
constexpr int kMinInliers = 40;      // matches that one rigid motion explains; with fewer, two images say nothing
constexpr double kMaxErrorPx = 3.0;  // of the motion that is found from the matches alone

}  // namespace

EpipolarMeter::EpipolarMeter(const Intrinsics& color, const OrbOptions& orb)
    : focal_px_(color.mean_focal_px()),
      candidates_(static_cast<std::size_t>(orb.num_features)),
      matcher_({.max_distance = 50}, orb.num_features, static_cast<std::size_t>(orb.num_features)),
      pairs_(static_cast<std::size_t>(orb.num_features)),
      ransac_({.max_error_px = kMaxErrorPx, .max_pairs = orb.num_features}) {}

std::optional<EpipolarError> EpipolarMeter::measure(const FrameFeatures& a, const FrameFeatures& b) {
  candidates_.clear();
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.depth_m[i] > 0) candidates_.add(a.features.descriptors[i], static_cast<std::int32_t>(i), a.features.keypoints[i].angle_rad);
  }
  pairs_.clear();
  for (const Match& match : matcher_.match(b.features, candidates_)) {
    const auto in_a = static_cast<std::size_t>(match.landmark), in_b = static_cast<std::size_t>(match.feature);
    const Eigen::Vector3f p = a.point_camera(in_a).cast<float>();
    pairs_.add(b.normalized[in_b].x(), b.normalized[in_b].y(), p.x(), p.y(), p.z(), b.depth_m[in_b], 1, match.distance, match.feature,
               match.landmark);
  }
  if (static_cast<int>(pairs_.size()) < kMinInliers) return std::nullopt;
  pairs_.sort_by_rank();
  const PnpRansacResult motion = ransac_.estimate(pairs_, focal_px_, 0);
  if (!motion.is_found || motion.num_inliers < kMinInliers) return std::nullopt;

  const Rigid3 T_b_a = b.T_map_camera.inverse() * a.T_map_camera;
  std::vector<double> errors_px;
  for (std::size_t i = 0; i < ransac_.inlier_mask().size(); ++i) {
    if (ransac_.inlier_mask()[i] == 0) continue;
    const Eigen::Vector2d in_a = a.normalized[static_cast<std::size_t>(pairs_.landmark[i])].cast<double>(),
                          in_b = b.normalized[static_cast<std::size_t>(pairs_.feature[i])].cast<double>();
    errors_px.push_back(focal_px_ * sampson_distance(T_b_a, in_a, in_b));
  }
  return EpipolarError{static_cast<int>(errors_px.size()), upper_median(errors_px)};
}

double sampson_distance(const Rigid3& T_b_a, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  // E = [t]x R: the epipolar lines are t x (R a) in b, and R^T (b x t) in a.
  const Eigen::Matrix3d R = T_b_a.rotation.toRotationMatrix();
  const Eigen::Vector3d t = T_b_a.translation.normalized(), in_a = a.homogeneous(), in_b = b.homogeneous();
  const Eigen::Vector3d line_b = t.cross(R * in_a), line_a = R.transpose() * in_b.cross(t);
  const double length = std::sqrt(line_a.head<2>().squaredNorm() + line_b.head<2>().squaredNorm());
  return length > 0 ? std::abs(in_b.dot(line_b)) / length : 0.0;
}

std::vector<std::size_t> most_similar_views(const Rigid3& T_map_camera, const std::vector<Rigid3>& others,
                                            const std::vector<bool>& is_excluded, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (is_excluded[i]) continue;
    const double turned_rad = rotation_distance_rad(T_map_camera.rotation, others[i].rotation);
    ranked.emplace_back((T_map_camera.translation - others[i].translation).norm() + kMetresPerRadian * turned_rad, i);
  }
  count = std::min(count, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  std::vector<std::size_t> best(count);
  std::transform(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), best.begin(), [](const auto& r) { return r.second; });
  return best;
}

}  // namespace camloc::tools
