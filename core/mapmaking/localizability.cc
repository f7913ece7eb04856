// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/localizability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/hamming.h"
#include "core/geometry/pose_jacobian.h"
#include "core/map/keyframe_view.h"
#include "core/map/map_unpack.h"
#include "core/map/retrieval.h"
#include "core/registration/image_cells.h"
#include "core/registration/pose_solver.h"
#include "core/registration/rivals.h"

namespace camloc {
namespace {

constexpr int kMaxPairs = 1000;

/// A keyframe as a query made of its own landmarks.
struct Query {
  KeyframeView of;
  std::vector<std::uint8_t> is_shared;  ///< of each landmark: other frames saw it, too
};

std::vector<Query> make_queries(const MapData& map, const LocalizabilityOptions& options) {
  std::vector<Query> queries(map.keyframes.size());
  for (std::uint32_t k = 0; k < queries.size(); ++k) {
    queries[k].of = view_of_keyframe(map, k);
    for (const std::uint32_t landmark : queries[k].of.landmarks)
      queries[k].is_shared.push_back(map.landmarks[landmark].num_observations >= options.min_observations ? 1 : 0);
  }
  return queries;
}

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

double common_share(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::size_t common = 0;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    const std::uint32_t left = a[i], right = b[k];
    common += left == right ? 1 : 0;
    i += left <= right ? 1 : 0;
    k += right <= left ? 1 : 0;
  }
  return static_cast<double>(common) / static_cast<double>(std::max<std::size_t>(1, std::min(a.size(), b.size())));
}

bool is_other_place(const KeyframeView& a, const KeyframeView& b, const LocalizabilityOptions& options) {
  return are_rivals(a.view.T_map_camera, b.view.T_map_camera, {options.rival_distance_m, options.rival_turn_rad}) &&
         common_share(a.landmarks, b.landmarks) <= options.max_common_share;
}

/// Where the landmarks of a map are, for poses from matches that are known already.
class MapPositions final : public LandmarkSource {
 public:
  explicit MapPositions(const MapData& map) : map_(&map) {}
  [[nodiscard]] std::span<const ProjectedLandmark> project(const Rigid3&, float) override { return {}; }
  [[nodiscard]] std::span<const Descriptor> descriptors() const override { return {}; }
  [[nodiscard]] Eigen::Vector3f position_m(std::int32_t i) const override {
    return map_->landmarks[static_cast<std::size_t>(i)].position_m;
  }

 private:
  const MapData* map_;
};

PoseSolverOptions solver_options(const LocalizabilityOptions& options, int max_features) {
  PoseSolverOptions solver;
  solver.max_features = max_features;
  solver.max_ransac_pairs = kMaxPairs;
  solver.max_ransac_error_px = options.max_error_px;
  solver.gathers_evidence = false;
  return solver;
}

/// Compares a view with other places. Buffers are kept from call to call.
class RivalFinder {
 public:
  RivalFinder(const MapView& map, const MapData& data, const std::vector<Query>& queries, const LocalizabilityOptions& options)
      : positions_(data),
        queries_(&queries),
        options_(options),
        most_(most_features(queries)),
        retriever_(map, most_),
        forward_(static_cast<std::size_t>(most_)),
        backward_(static_cast<std::size_t>(most_)),
        solver_(data.camera, PyramidLevels(data.orb_scale_factor, static_cast<int>(data.orb_num_levels)), solver_options(options, most_)) {}

  std::optional<RivalPlace> find(std::uint32_t keyframe) {
    const KeyframeView& here = (*queries_)[keyframe].of;
    solver_.begin(here.view);
    std::optional<RivalPlace> worst;
    int num_compared = 0;
    for (const RankedKeyframe& retrieved : retriever_.retrieve(here.view.features.descriptors, static_cast<int>(queries_->size()))) {
      if (!is_other_place(here, (*queries_)[retrieved.keyframe].of, options_)) continue;
      const RivalPlace rival = compare(here, retrieved.keyframe, keyframe);
      if (!worst || rival.num_inliers > worst->num_inliers ||
          (rival.num_inliers == worst->num_inliers && rival.matched_share > worst->matched_share)) {
        worst = rival;
      }
      if (++num_compared == options_.max_rivals) break;
    }
    return worst;
  }

 private:
  static int most_features(const std::vector<Query>& queries) {
    std::size_t most = 1;
    for (const Query& query : queries) most = std::max(most, query.of.view.size());
    return static_cast<int>(most);
  }

  RivalPlace compare(const KeyframeView& here, std::uint32_t rival_keyframe, std::uint64_t seed) {
    const KeyframeView& there = (*queries_)[rival_keyframe].of;
    nearest_descriptors(here.view.features.descriptors, there.view.features.descriptors, forward_.data());
    nearest_descriptors(there.view.features.descriptors, here.view.features.descriptors, backward_.data());
    matches_.clear();
    for (std::size_t i = 0; i < here.landmarks.size(); ++i) {
      const NearestDescriptor& nearest = forward_[i];
      if (nearest.distance > options_.max_match_distance || backward_[nearest.index].index != i) continue;
      const auto landmark = static_cast<std::int32_t>(there.landmarks[nearest.index]);
      const Eigen::Vector3f apart = positions_.position_m(static_cast<std::int32_t>(here.landmarks[i])) - positions_.position_m(landmark);
      if (apart.norm() < options_.same_point_m) continue;
      matches_.push_back({.feature = static_cast<std::int32_t>(i), .landmark = landmark, .distance = nearest.distance});
    }
    RivalPlace place{rival_keyframe, 0, static_cast<std::uint32_t>(matches_.size()), 0};
    place.matched_share = static_cast<double>(matches_.size()) / static_cast<double>(std::max<std::size_t>(1, here.landmarks.size()));
    place.num_inliers = solver_.solve(positions_, matches_, seed).num_inliers;
    return place;
  }

  MapPositions positions_;
  const std::vector<Query>* queries_;
  LocalizabilityOptions options_;
  int most_;
  Retriever retriever_;
  std::vector<NearestDescriptor> forward_, backward_;
  std::vector<Match> matches_;
  PoseSolver solver_;
};

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
  const std::vector<Query> queries = make_queries(data, options);
  RivalFinder rivals(map, data, queries, options);
  std::vector<KeyframeLocalizability> places(queries.size());
  for (std::uint32_t k = 0; k < queries.size(); ++k) {
    KeyframeLocalizability& place = places[k];
    assess_precision(queries[k], data, map.info(), options, &place);
    place.rival = rivals.find(k);
    place.weakness = weakness_of(place, options);
    if (place.weakness != FixWeakness::kNone)
      place.outlook = FixOutlook::kScanAgain;
    else if (is_look_alike(place, options))
      place.outlook = FixOutlook::kLookAlike;
  }
  return places;
}

}  // namespace camloc
