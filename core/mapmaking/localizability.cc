// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/localizability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

#include "core/features/hamming.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_jacobian.h"
#include "core/map/retrieval.h"

namespace camloc {
namespace {

constexpr int kSpreadColumns = 8, kSpreadRows = 6;
constexpr double kMinDepthM = 0.05;
constexpr int kMaxPairs = 1000;

/// A landmark as a keyframe sees it.
struct SeenLandmark {
  std::uint32_t landmark = 0;
  Eigen::Vector3d position_m;  ///< in `map`
  Eigen::Vector3d p_camera;
  double sigma_px = 1;          ///< of its keypoint
  double position_sigma_m = 0;  ///< of the landmark itself
  bool is_shared = false;       ///< other frames saw it, too
  int cell = 0;                 ///< of the image
};

struct View {
  Rigid3 T_map_camera;
  std::vector<SeenLandmark> landmarks;  ///< ascending
  std::vector<Descriptor> descriptors;  ///< the first of each
};

double keypoint_sigma_px(const MapView& map, const map_format::LandmarkRecord& record, double distance_m, double pixel_sigma_px) {
  const MapInfo& info = map.info();
  const double reference_m =
      std::sqrt(static_cast<double>(MapView::reference_m(record.min_reference)) * MapView::reference_m(record.max_reference));
  const double scale = static_cast<double>(info.orb_scale_factor);
  const double level = std::log(reference_m / distance_m) / std::log(scale);
  return pixel_sigma_px * std::pow(scale, std::clamp(level, 0.0, static_cast<double>(info.orb_num_levels) - 1));
}

View make_view(const MapView& map, std::uint32_t keyframe, const LocalizabilityOptions& options, std::vector<std::uint32_t>* buffer) {
  const Intrinsics& color = map.info().camera.color;
  View view{map.keyframe_pose(keyframe), {}, {}};
  const Rigid3 T_camera_map = view.T_map_camera.inverse();
  const std::size_t count = map.keyframe_landmarks(keyframe, *buffer);
  for (const std::uint32_t landmark : std::span(*buffer).first(count)) {
    if (landmark >= map.landmarks().size()) continue;
    const auto& record = map.landmarks()[landmark];
    SeenLandmark seen;
    seen.landmark = landmark;
    seen.position_m = map.position_m(landmark).cast<double>();
    seen.p_camera = T_camera_map * seen.position_m;
    if (!(seen.p_camera.z() > kMinDepthM)) continue;
    const Eigen::Vector2d pixel = color.project(seen.p_camera);
    if (!(pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < color.width - 0.5 && pixel.y() < color.height - 0.5)) continue;
    seen.cell = static_cast<int>((pixel.y() + 0.5) * kSpreadRows / color.height) * kSpreadColumns +
                static_cast<int>((pixel.x() + 0.5) * kSpreadColumns / color.width);
    seen.sigma_px = keypoint_sigma_px(map, record, seen.p_camera.norm(), options.pixel_sigma_px);
    seen.position_sigma_m = 1e-3 * record.position_sigma_mm;
    seen.is_shared = record.num_observations >= options.min_observations;
    view.landmarks.push_back(seen);
    view.descriptors.push_back(map.landmark_descriptors(landmark).front());
  }
  return view;
}

double spread_of(const View& view) {
  std::bitset<kSpreadColumns * kSpreadRows> occupied;
  for (const SeenLandmark& seen : view.landmarks) {
    if (seen.is_shared) occupied.set(static_cast<std::size_t>(seen.cell));
  }
  return static_cast<double>(occupied.count()) / static_cast<double>(occupied.size());
}

/// Information of the pose (camera axes, see pose_jacobian.h) from reprojection and depth of the landmarks that are found again.
Matrix6d expected_information(const View& view, const RgbdCamera& camera, const LocalizabilityOptions& options) {
  const double focal_px = camera.color.mean_focal_px();
  Matrix6d information = Matrix6d::Zero();
  for (const SeenLandmark& seen : view.landmarks) {
    if (!seen.is_shared) continue;
    const double z = seen.p_camera.z(), u = seen.p_camera.x() / z, v = seen.p_camera.y() / z;
    const PointJacobian J = point_jacobian(u, v, z);
    const double sigma_image = std::hypot(seen.sigma_px / focal_px, seen.position_sigma_m / z);
    information += (J.u * J.u.transpose() + J.v * J.v.transpose()) * (options.repeatability / (sigma_image * sigma_image));
    if (z < camera.min_depth_m || z > camera.max_depth_m) continue;
    const double sigma_depth = std::hypot(camera.depth_noise.sigma_m(z), seen.position_sigma_m);
    information += J.z * J.z.transpose() * (options.repeatability / (sigma_depth * sigma_depth));
  }
  return information;
}

void assess_precision(const View& view, const MapInfo& info, const LocalizabilityOptions& options, KeyframeLocalizability* result) {
  for (const SeenLandmark& seen : view.landmarks) result->num_landmarks += seen.is_shared ? 1 : 0;
  result->spread = spread_of(view);
  result->position_sigma_m = result->rotation_sigma_rad = std::numeric_limits<double>::infinity();
  const Eigen::LDLT<Matrix6d> ldlt(expected_information(view, info.camera, options));
  if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-14)) return;
  const Matrix6d covariance = ldlt.solve(Matrix6d::Identity());
  const auto worst = [](const Eigen::Matrix3d& block) {
    return std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block).eigenvalues()[2]);
  };
  result->position_sigma_m = std::hypot(std::sqrt(worst(covariance.topLeftCorner<3, 3>())), info.pose_sigma_m);
  result->rotation_sigma_rad = std::hypot(std::sqrt(worst(covariance.bottomRightCorner<3, 3>())), info.pose_sigma_rad);
}

double common_share(const View& a, const View& b) {
  std::size_t common = 0;
  for (std::size_t i = 0, k = 0; i < a.landmarks.size() && k < b.landmarks.size();) {
    const std::uint32_t left = a.landmarks[i].landmark, right = b.landmarks[k].landmark;
    common += left == right ? 1 : 0;
    i += left <= right ? 1 : 0;
    k += right <= left ? 1 : 0;
  }
  return static_cast<double>(common) / static_cast<double>(std::max<std::size_t>(1, std::min(a.landmarks.size(), b.landmarks.size())));
}

bool is_other_place(const View& a, const View& b, const LocalizabilityOptions& options) {
  const double distance_m = (a.T_map_camera.translation - b.T_map_camera.translation).norm();
  const double turn_rad = rotation_distance_rad(a.T_map_camera.rotation, b.T_map_camera.rotation);
  return (distance_m > options.rival_distance_m || turn_rad > options.rival_turn_rad) && common_share(a, b) <= options.max_common_share;
}

/// Compares a view with other places. Buffers are kept from call to call.
class RivalFinder {
 public:
  RivalFinder(const MapView& map, const std::vector<View>& views, const LocalizabilityOptions& options)
      : map_(&map), views_(&views), options_(options), pairs_(kMaxPairs), ransac_(ransac_options(options)) {
    std::size_t most = 0;
    for (const View& view : views) most = std::max(most, view.descriptors.size());
    retriever_.emplace(map, static_cast<int>(most));
    forward_.resize(most);
    backward_.resize(most);
  }

  std::optional<RivalPlace> find(std::uint32_t keyframe) {
    const View& view = (*views_)[keyframe];
    std::optional<RivalPlace> worst;
    int num_compared = 0;
    for (const RetrievedKeyframe& retrieved : retriever_->retrieve(view.descriptors, static_cast<int>(views_->size()))) {
      if (!is_other_place(view, (*views_)[retrieved.keyframe], options_)) continue;
      const RivalPlace rival = compare(view, retrieved.keyframe, keyframe);
      if (!worst || rival.num_inliers > worst->num_inliers ||
          (rival.num_inliers == worst->num_inliers && rival.matched_share > worst->matched_share)) {
        worst = rival;
      }
      if (++num_compared == options_.max_rivals) break;
    }
    return worst;
  }

 private:
  static PnpRansacOptions ransac_options(const LocalizabilityOptions& options) {
    PnpRansacOptions ransac;
    ransac.max_error_px = options.max_error_px;
    ransac.max_pairs = kMaxPairs;
    return ransac;
  }

  RivalPlace compare(const View& view, std::uint32_t rival_keyframe, std::uint64_t seed) {
    const View& rival = (*views_)[rival_keyframe];
    nearest_descriptors(view.descriptors, rival.descriptors, forward_.data());
    nearest_descriptors(rival.descriptors, view.descriptors, backward_.data());
    pairs_.clear();
    RivalPlace place{rival_keyframe, 0, 0, 0};
    for (std::size_t i = 0; i < view.landmarks.size(); ++i) {
      const NearestDescriptor& nearest = forward_[i];
      if (nearest.distance > options_.max_match_distance || backward_[nearest.index].index != i) continue;
      const SeenLandmark& here = view.landmarks[i];
      const SeenLandmark& there = rival.landmarks[nearest.index];
      if ((here.position_m - there.position_m).norm() < options_.same_point_m) continue;
      ++place.num_matches;
      add_pair(here, there, nearest.distance);
    }
    place.matched_share = static_cast<double>(place.num_matches) / static_cast<double>(std::max<std::size_t>(1, view.landmarks.size()));
    pairs_.sort_by_rank();
    const PnpRansacResult pose = ransac_.estimate(pairs_, map_->info().camera.color.mean_focal_px(), seed);
    if (pose.is_found) place.num_inliers = static_cast<std::uint32_t>(pose.num_inliers);
    return place;
  }

  void add_pair(const SeenLandmark& here, const SeenLandmark& there, int distance) {
    const Eigen::Vector3f p = here.p_camera.cast<float>(), q = there.position_m.cast<float>();
    pairs_.add(p.x() / p.z(), p.y() / p.z(), q.x(), q.y(), q.z(), p.z(), static_cast<float>(here.sigma_px), static_cast<float>(distance),
               static_cast<std::int32_t>(here.landmark), static_cast<std::int32_t>(there.landmark));
  }

  const MapView* map_;
  const std::vector<View>* views_;
  LocalizabilityOptions options_;
  std::optional<Retriever> retriever_;
  std::vector<NearestDescriptor> forward_, backward_;
  Correspondences pairs_;
  PnpRansac ransac_;
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
  std::vector<std::uint32_t> buffer(map.info().max_keyframe_landmarks);
  std::vector<View> views;
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) views.push_back(make_view(map, k, options, &buffer));
  RivalFinder rivals(map, views, options);
  std::vector<KeyframeLocalizability> places(views.size());
  for (std::uint32_t k = 0; k < views.size(); ++k) {
    KeyframeLocalizability& place = places[k];
    assess_precision(views[k], map.info(), options, &place);
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
