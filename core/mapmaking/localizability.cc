// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/localizability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/pose_jacobian.h"
#include "core/map/map_unpack.h"
#include "core/registration/image_cells.h"
#include "core/registration/keypoint_noise.h"

namespace camloc {
namespace {

/// A keyframe as a query made of its own landmarks.
struct Query {
  const KeyframeView& of;
  std::vector<std::uint8_t> is_shared;  ///< of each landmark: other frames saw it, too

  Query(const KeyframeView& keyframe, const MapData& map, const LocalizabilityOptions& options) : of(keyframe) {
    for (const std::uint32_t landmark : of.landmarks)
      is_shared.push_back(map.landmarks[landmark].num_observations >= options.min_observations ? 1 : 0);
  }
};

double spread_of(const Query& query, const Intrinsics& color) {
  ImageCells cells(color.width, color.height);
  for (std::size_t i = 0; i < query.is_shared.size(); ++i) {
    const Keypoint& keypoint = query.of.view.features.keypoints[i];
    if (query.is_shared[i] != 0) cells.add(keypoint.u, keypoint.v);
  }
  return cells.share();
}

/// Information of the pose (camera axes, see pose_jacobian.h) from reprojection and depth of the landmarks that are found again.
Matrix6d expected_information(const Query& query, const MapData& map, const LocalizabilityOptions& options) {
  const PyramidLevels levels(map.orb_scale_factor, static_cast<int>(map.orb_num_levels));
  const double focal_px = map.camera.color.mean_focal_px();
  const Rigid3 T_camera_map = query.of.view.T_map_camera.inverse();
  Matrix6d information = Matrix6d::Zero();
  for (std::size_t i = 0; i < query.is_shared.size(); ++i) {
    if (query.is_shared[i] == 0) continue;
    const MapLandmark& landmark = map.landmarks[query.of.landmarks[i]];
    const Eigen::Vector2f at = query.of.view.normalized[i];
    const double z = (T_camera_map * landmark.position_m.cast<double>()).z();
    const PointJacobian J = point_jacobian(at.x(), at.y(), z);
    const double sigma_px = pair_sigma_px(levels.scale(query.of.view.features.keypoints[i].level), kMapLandmarkSigmaPx);
    const double sigma_image = std::hypot(sigma_px / focal_px, landmark.position_sigma_m / z);
    information += (J.u * J.u.transpose() + J.v * J.v.transpose()) * (options.repeatability / (sigma_image * sigma_image));
    if (query.of.view.depth_m[i] == 0) continue;
    const double sigma_depth = std::hypot(map.camera.depth_noise.sigma_m(z), landmark.position_sigma_m);
    information += J.z * J.z.transpose() * (options.repeatability / (sigma_depth * sigma_depth));
  }
  return information;
}

void assess_precision(const Query& query, const MapData& map, const MapInfo& info, const LocalizabilityOptions& options,
                      KeyframeLocalizability* result) {
  result->num_landmarks = static_cast<std::uint32_t>(std::count(query.is_shared.begin(), query.is_shared.end(), std::uint8_t{1}));
  result->spread = spread_of(query, map.camera.color);
  result->position_sigma_m = result->rotation_sigma_rad = std::numeric_limits<double>::infinity();
  const Eigen::LDLT<Matrix6d> ldlt(expected_information(query, map, options));
  if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-14)) return;
  const Matrix6d covariance = ldlt.solve(Matrix6d::Identity());
  const auto worst = [](const Eigen::Matrix3d& block) {
    return std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block).eigenvalues()[2]);
  };
  result->position_sigma_m = std::hypot(std::sqrt(worst(covariance.topLeftCorner<3, 3>())), info.pose_sigma_m);
  result->rotation_sigma_rad = std::hypot(std::sqrt(worst(covariance.bottomRightCorner<3, 3>())), info.pose_sigma_rad);
}

std::optional<RivalPlace> most_deceiving(const std::vector<RivalPlace>& rivals) {
  const auto worst = std::max_element(rivals.begin(), rivals.end(), [](const RivalPlace& a, const RivalPlace& b) {
    return std::pair(a.num_inliers, a.matched_share) < std::pair(b.num_inliers, b.matched_share);
  });
  return worst == rivals.end() ? std::nullopt : std::optional(*worst);
}

FixWeakness weakness_of(const KeyframeLocalizability& place, const LocalizabilityOptions& options) {
  if (place.num_landmarks < options.min_landmarks) return FixWeakness::kFewLandmarks;
  if (place.spread < options.min_spread) return FixWeakness::kPoorSpread;
  if (!(place.position_sigma_m <= options.max_position_sigma_m)) return FixWeakness::kImprecise;
  return FixWeakness::kNone;
}

bool is_look_alike(const KeyframeLocalizability& place, const LocalizabilityOptions& options) {
  return place.rival && (place.rival->matched_share >= options.min_rival_share || place.rival->num_inliers >= options.min_rival_inliers);
}

}  // namespace

std::vector<KeyframeLocalizability> assess_localizability(const MapView& map, const LocalizabilityOptions& options) {
  const MapData data = unpack_map(map);
  RivalSearch rivals(map, data, options.rivals);
  std::vector<KeyframeLocalizability> places(data.keyframes.size());
  for (std::uint32_t k = 0; k < places.size(); ++k) {
    KeyframeLocalizability& place = places[k];
    assess_precision(Query(rivals.view(k), data, options), data, map.info(), options, &place);
    place.rival = most_deceiving(rivals.find(k));
    place.weakness = weakness_of(place, options);
    if (place.weakness != FixWeakness::kNone)
      place.outlook = FixOutlook::kScanAgain;
    else if (is_look_alike(place, options))
      place.outlook = FixOutlook::kLookAlike;
  }
  return places;
}

}  // namespace camloc
