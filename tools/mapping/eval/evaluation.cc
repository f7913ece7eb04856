// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// evaluate_map is the job on one screen: find a start (points, trajectory, datum, or a search from which every candidate is refined
// and the best compared with its rivals), refine it by trimmed ICP, check the scale, measure distances both ways. Everything is
// relative to the cloud's origin until the result is made absolute: survey coordinates do not fit floats.
#include "tools/mapping/eval/evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/geometry/alignment.h"
#include "tools/common/map_points.h"
#include "tools/common/text_format.h"

namespace camloc::mapping {
namespace {

using tools::text_of;

constexpr std::size_t kMaxFinalPoints = 50000;  // of the last registration; more change nothing
constexpr std::size_t kMaxSearchPoints = 3000;  // for each start of a search
constexpr double kSearchDistanceM = 1.5, kSearchTrim = 0.8;
constexpr double kPoseLeverM = 1.0;  // what a rotation weighs against a position between two trajectories

Status check_points(const MapView& map, const std::vector<Eigen::Vector3d>& points, std::uint32_t min_observations) {
  if (map.landmarks().empty()) return {ErrorCode::kInvalid, map.info().path + ": has no landmarks, there is nothing to evaluate"};
  if (!points.empty()) return Status::ok();
  return {ErrorCode::kInvalid, text_of("%s: none of its %zu landmarks was seen at least %u times; lower --min-observations",
                                       map.info().path.c_str(), map.landmarks().size(), min_observations)};
}

/// The pose in a frame whose origin is at `-offset`.
Rigid3 shifted(Rigid3 T, const Eigen::Vector3d& offset) {
  T.translation += offset;
  return T;
}

Eigen::Vector3d extent_of(const std::vector<Eigen::Vector3d>& points) {
  const auto bounds = thinned(points, 0.05).bounds_m();
  return bounds[1] - bounds[0];
}

/// Scanners and CAD programs like millimetres.
Status check_unit(const std::vector<Eigen::Vector3d>& points, const PointCloud& cloud) {
  const auto bounds = cloud.bounds_m();
  const Eigen::Vector3d cloud_box = bounds[1] - bounds[0], map_box = extent_of(points);
  const double cloud_m = cloud_box.norm(), map_m = map_box.norm();
  const auto seems = [&](const char* unit, const char* option) {
    return Status(ErrorCode::kInvalid,
                  text_of("the cloud is %.0f m wide and the map %.1f m: the cloud seems to be in %s; say so with --lidar-unit %s", cloud_m,
                          map_m, unit, option));
  };
  if (cloud_m > 300 * map_m && cloud_m < 5000 * map_m && cloud_m > 1000) return seems("millimetres", "mm");
  // A site may well be a hundred times wider than the map of one flat, but it is not a hundred times higher.
  const double height = cloud_box.minCoeff(), height_ratio = height / std::max(map_box.minCoeff(), 0.1);
  if (height > 100 && height_ratio > 30 && height_ratio < 300 && cloud_m > 30 * map_m) return seems("centimetres", "cm");
  return Status::ok();
}

std::vector<PointPair> pairs_of(const std::vector<ControlPair>& controls, const Eigen::Vector3d& origin_m) {
  std::vector<PointPair> pairs;
  for (const ControlPair& control : controls) pairs.push_back({control.p_cloud - origin_m, control.p_map, control.sigma_m});
  return pairs;
}

/// Camera positions; `has_axes`: and, with a lever arm, viewing directions, so that a camera that only turned can be aligned,
/// too.
std::vector<PointPair> pairs_of(const std::vector<PosePair>& poses, const Eigen::Vector3d& origin_m, bool has_axes) {
  std::vector<PointPair> pairs;
  for (const PosePair& pose : poses) {
    add_pose_points(shifted(pose.T_reference_camera, -origin_m), pose.T_map_camera, has_axes ? kPoseLeverM : 0, &pairs);
  }
  return pairs;
}

Result<Rigid3> align(const std::vector<PointPair>& pairs, const char* what) {
  const Alignment aligned = align_rigid(pairs);
  if (aligned.rank == AlignmentRank::kFull) return aligned.T_a_b;
  return {ErrorCode::kInvalid, std::string(what) + ": all lie on one line, which leaves the rotation about it open; add one aside"};
}

AlignStart choose_start(const EvaluationInput& input, AlignStart wish) {
  if (wish != AlignStart::kAuto) return wish;
  if (!input.points.empty()) return AlignStart::kPoints;
  if (!input.poses.empty()) return AlignStart::kTrajectory;
  return input.map->info().wcs ? AlignStart::kDatum : AlignStart::kSearch;
}

/// To half a metre for the farthest of the points.
bool is_same_place(const Rigid3& a, const Rigid3& b, const std::vector<Eigen::Vector3d>& points) {
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) { return (a * p - b * p).norm() < 0.5; });
}

/// Every coarse start is refined; what fits best wins.
Result<Rigid3> search_start(const EvaluationInput& input, const std::vector<Eigen::Vector3d>& points, const EvaluationOptions& options,
                            CloudIndex* cloud, SearchOutcome* outcome) {
  const auto starts = find_coarse_starts(points, input.cloud->points_m, input.cloud->origin_m);
  if (!starts.is_ok()) return starts.status();
  const RegistrationOptions registration{.trim = std::min(options.trim, kSearchTrim),
                                         .max_distance_m = options.max_distance_m,
                                         .start_distance_m = std::max(kSearchDistanceM, options.max_distance_m),
                                         .max_points = kMaxSearchPoints};
  std::vector<Eigen::Vector3d> some;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kMaxSearchPoints + 1) some.push_back(points[i]);
  std::vector<CoarseStart> refined;  // score_m is the capped mean distance from here on
  for (const CoarseStart& start : starts.value()) {
    const auto result = register_points(some, cloud, {1, start.T_cloud_map}, registration);
    if (!result.is_ok()) continue;
    const Rigid3& T_cloud_map = result.value().T_cloud_map.rigid;
    refined.push_back({T_cloud_map, capped_mean_distance(some, *cloud, T_cloud_map, options.max_distance_m), start.is_identity});
  }
  if (refined.empty())
    return {ErrorCode::kNotFound,
            "no place was found where the map fits into the cloud; is it the same site? Control points (--points) would help"};
  // A map that fits in its own frame is meant to be there.
  const auto handicapped_m = [](const CoarseStart& start) { return start.score_m * (start.is_identity ? 0.9 : 1); };
  const CoarseStart best = *std::min_element(
      refined.begin(), refined.end(), [&](const CoarseStart& a, const CoarseStart& b) { return handicapped_m(a) < handicapped_m(b); });
  *outcome = {best.score_m, options.max_distance_m, best.is_identity, starts.value().size()};
  for (const CoarseStart& other : refined) {
    if (!is_same_place(other.T_cloud_map, best.T_cloud_map, some)) outcome->rival_score_m = std::min(outcome->rival_score_m, other.score_m);
  }
  return best.is_identity ? Rigid3{Eigen::Quaterniond::Identity(), -input.cloud->origin_m} : best.T_cloud_map;
}

/// T_cloud_map relative to the cloud's origin.
Result<Rigid3> find_start(const EvaluationInput& input, const std::vector<Eigen::Vector3d>& points, const EvaluationOptions& options,
                          CloudIndex* cloud, Evaluation* result) {
  const Eigen::Vector3d& origin_m = input.cloud->origin_m;
  switch (result->start) {
    case AlignStart::kPoints: {
      if (input.points.empty()) return {ErrorCode::kInvalid, "--align points needs control points: --points FILE"};
      return align(pairs_of(input.points, origin_m), "control points");
    }
    case AlignStart::kTrajectory: {
      if (input.poses.empty())
        return {ErrorCode::kInvalid,
                "--align trajectory needs --trajectory FILE, and poses to compare it with: --reference-trajectory FILE or "
                "--reference-sequence DIR"};
      return align(pairs_of(input.poses, origin_m, true), "trajectory");
    }
    case AlignStart::kDatum:
      if (!input.map->info().wcs)
        return {ErrorCode::kInvalid, "--align datum: " + input.map->info().path + " has no datum; camloc map georef gives it one"};
      return shifted(input.map->info().wcs->T_wcs_map, -origin_m);
    case AlignStart::kAuto:
    case AlignStart::kSearch: {
      result->search.emplace();
      return search_start(input, points, options, cloud, &*result->search);
    }
    case AlignStart::kNone: break;
  }
  return shifted({}, -origin_m);
}

/// Trimmed ICP on a part of the landmarks, then on more of them.
Result<Registration> refine(const std::vector<Eigen::Vector3d>& points, const Rigid3& start, const EvaluationOptions& options,
                            AlignStart kind, CloudIndex* cloud) {
  const double found_m = kind == AlignStart::kDatum || kind == AlignStart::kTrajectory ? 1.0 : 0.5;
  RegistrationOptions registration{
      .trim = options.trim, .max_distance_m = options.max_distance_m, .start_distance_m = std::max(found_m, options.max_distance_m)};
  auto coarse = register_points(points, cloud, {1, start}, registration);
  if (!coarse.is_ok() || points.size() <= registration.max_points) return coarse;
  registration.start_distance_m = registration.max_distance_m;
  registration.max_points = kMaxFinalPoints;
  registration.max_iterations = 20;
  return register_points(points, cloud, coarse.value().T_cloud_map, registration);
}

/// RMS distance from the middle, in the cloud.
double spread_of(const std::vector<PointPair>& pairs) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PointPair& pair : pairs) mean += pair.p_a / static_cast<double>(pairs.size());
  double sum = 0;
  for (const PointPair& pair : pairs) sum += (pair.p_a - mean).squaredNorm() / static_cast<double>(pairs.size());
  return std::sqrt(sum);
}

void check_scale(const EvaluationInput& input, const std::vector<Eigen::Vector3d>& points, const Rigid3& T_cloud_map,
                 const EvaluationOptions& options, CloudIndex* cloud, Evaluation* result) {
  const RegistrationOptions registration{.trim = options.trim,
                                         .max_distance_m = options.max_distance_m,
                                         .start_distance_m = options.max_distance_m,
                                         .max_iterations = 40,
                                         .has_scale = true};
  if (const auto similar = register_points(points, cloud, {1, T_cloud_map}, registration); similar.is_ok()) {
    result->scale = similar.value().T_cloud_map.scale;
    result->sigma_scale = similar.value().sigma_scale;
  }
  const auto measure = [](const std::vector<PointPair>& pairs, std::optional<double>* scale, double* tolerance) {
    const Alignment aligned = align_similarity(pairs);
    if (aligned.rank == AlignmentRank::kNothing || aligned.rank == AlignmentRank::kPosition) return;
    *scale = aligned.scale;
    *tolerance = std::max(*tolerance, 2 * aligned.rms_m / std::max(1e-9, spread_of(pairs)));
  };
  measure(pairs_of(input.points, input.cloud->origin_m), &result->points_scale, &result->points_scale_tolerance);
  measure(pairs_of(input.poses, input.cloud->origin_m, false), &result->poses_scale, &result->poses_scale_tolerance);
}

void measure_residuals(const EvaluationInput& input, const Rigid3& T_cloud_map, Evaluation* result) {
  if (input.points.empty()) return;
  const Rigid3 aligned = align_rigid(pairs_of(input.points, input.cloud->origin_m)).T_a_b;
  for (const ControlPair& pair : input.points) {
    const Eigen::Vector3d p_cloud = pair.p_cloud - input.cloud->origin_m;
    const Eigen::Vector3d final_m = T_cloud_map * pair.p_map - p_cloud;
    result->residuals.push_back({pair.name, pair.sigma_m, aligned * pair.p_map - p_cloud, final_m});
  }
}

}  // namespace

const char* describe(AlignStart start) {
  constexpr const char* kNames[] = {"automatic", "control points", "trajectory", "datum of the map", "none (frames taken as equal)",
                                    "search"};
  return kNames[static_cast<std::size_t>(start)];
}

Result<Evaluation> evaluate_map(const EvaluationInput& input, const EvaluationOptions& options, WorkObserver& observer) {
  const Status stopped(ErrorCode::kIo, "interrupted");
  const std::vector<Eigen::Vector3d> points = tools::landmark_positions(*input.map, options.min_observations);
  if (const Status checked = check_points(*input.map, points, options.min_observations); !checked.is_ok()) return checked;
  if (const Status checked = check_unit(points, *input.cloud); !checked.is_ok()) return checked;
  Evaluation result;
  result.num_landmarks = input.map->landmarks().size();
  result.num_used = points.size();
  result.num_keyframes = input.map->keyframes().size();

  if (!observer.on_progress("indexing the cloud ...")) return stopped;
  CloudIndex cloud(input.cloud->points_m);
  if (!observer.on_progress("looking for a start ...")) return stopped;
  result.start = choose_start(input, options.start);
  const auto start = find_start(input, points, options, &cloud, &result);
  if (!start.is_ok()) return start.status();
  Rigid3 T_cloud_map = start.value();
  if (options.has_icp) {
    if (!observer.on_progress("aligning ...")) return stopped;
    const auto refined = refine(points, T_cloud_map, options, result.start, &cloud);
    if (!refined.is_ok()) {
      return {ErrorCode::kNotFound,
              "map and cloud do not overlap (start: " + std::string(describe(result.start)) + "): " + refined.status().message()};
    }
    result.registration = refined.value();
    T_cloud_map = refined.value().T_cloud_map.rigid;
  }
  if (!observer.on_progress("checking the scale ...")) return stopped;
  check_scale(input, points, T_cloud_map, options, &cloud, &result);

  if (!observer.on_progress("measuring distances ...")) return stopped;
  for (const Eigen::Vector3d& p : points) result.landmarks_m.push_back(T_cloud_map * p);
  for (const Rigid3& T : tools::keyframe_poses(*input.map)) {
    result.T_cloud_keyframe.push_back(T_cloud_map * T);
    result.keyframes_m.push_back(result.T_cloud_keyframe.back().translation);
  }
  result.max_distance_m = options.max_distance_m;
  result.distances = measure_distances(result.landmarks_m, result.keyframes_m, &cloud, options.max_distance_m);
  measure_residuals(input, T_cloud_map, &result);
  result.T_cloud_map_start = shifted(start.value(), input.cloud->origin_m);
  result.T_cloud_map = shifted(T_cloud_map, input.cloud->origin_m);
  const Eigen::Vector3d center =
      std::accumulate(points.begin(), points.end(), Eigen::Vector3d(0, 0, 0)) / static_cast<double>(points.size());
  result.moved_m = (T_cloud_map * center - start.value() * center).norm();
  result.moved_rad = rotation_distance_rad(T_cloud_map.rotation, start.value().rotation);
  return result;
}

}  // namespace camloc::mapping
