// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording floats until something holds it. Control points are resolved to points of the map, fitted, and given to the bundle
// adjustment as surveyed landmarks; a second fit, on the adjusted map and with the strict tolerance, gives the datum.
#include "tools/mapping/build/recording_site.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <unordered_map>

#include "core/io/sequence.h"
#include "drivers/source_url.h"
#include "drivers/sources.h"
#include "tools/common/frame_reading.h"
#include "tools/common/text_format.h"

namespace camloc::mapping {
namespace {

constexpr double kToleranceM = 0.10, kDeformationPerM = 0.01;

std::vector<StampedPose> trajectory_of(const SlamResult& result) {
  std::vector<StampedPose> trajectory;
  for (const SlamPose& pose : result.poses) {
    if (pose.segment == result.segments.front().id) trajectory.push_back({pose.stamp_ns, pose.T_map_camera});
  }
  return trajectory;
}

Result<GravityEstimate> up_from_accelerometer(const SlamResult& result, const std::string& path) {
  const auto samples = read_accelerometer(path);
  if (!samples.is_ok()) return samples.status();
  return gravity_from_accelerometer(with_orientations(samples.value(), trajectory_of(result)));
}

Result<GravityEstimate> up_from_floor(const SlamResult& result, const std::vector<KeyframeSurface>& surfaces) {
  std::unordered_map<std::uint64_t, Rigid3> pose_of_frame;
  for (const SlamPose& pose : result.poses) {
    if (pose.segment == result.segments.front().id && pose.is_keyframe) pose_of_frame.emplace(pose.frame, pose.T_map_camera);
  }
  std::vector<Eigen::Vector3d> points, centers;
  std::vector<Rigid3> cameras;
  for (const KeyframeSurface& surface : surfaces) {
    const auto pose = pose_of_frame.find(surface.frame);
    if (pose == pose_of_frame.end()) continue;
    cameras.push_back(pose->second);
    centers.push_back(pose->second.translation);
    for (const Eigen::Vector3f& p : surface.points_m) points.push_back(pose->second * p.cast<double>());
  }
  const auto up = rough_up(cameras);
  if (!up) return Status(ErrorCode::kNotFound, "the camera was held in all orientations");
  return gravity_from_floor(points, centers, *up);
}

/// The measurements of the survey as the map has them now.
ResolvedObservations resolve(const Survey& survey, const RgbdCamera& camera, const SlamResult& result) {
  std::unordered_map<std::uint64_t, const SlamPose*> pose_of_frame;
  for (const SlamPose& pose : result.poses) pose_of_frame.emplace(pose.frame, &pose);
  ControlSources sources;
  sources.T_map_camera = [&](std::uint64_t frame) -> Result<PoseWithCovariance> {
    const auto pose = pose_of_frame.find(frame);
    if (pose == pose_of_frame.end()) return Status(ErrorCode::kNotFound, "the frame was not tracked");
    if (pose->second->segment != result.segments.front().id) return Status(ErrorCode::kNotFound, "the frame is in another segment");
    return PoseWithCovariance{pose->second->T_map_camera, Matrix6d::Zero()};
  };
  sources.pixel = [&](const ControlObservation& pixel) { return survey.measurements.at(pixel.line); };
  return resolve_observations(survey.observations, camera, sources);
}

std::vector<ControlLandmark> control_landmarks(const Survey& survey, const GeorefFit& fit, const Slam& slam) {
  std::vector<ControlLandmark> controls;
  const Rigid3 T_map_wcs = fit.datum.T_wcs_map.inverse();
  for (const GeorefPoint& point : fit.points) {
    if (!is_in_fit(point.verdict)) continue;
    const auto surveyed =
        std::find_if(survey.points.begin(), survey.points.end(), [&](const ControlPoint& p) { return p.name == point.name; });
    ControlLandmark control{T_map_wcs * surveyed->p_wcs, surveyed->sigma_m, {}};
    for (const ControlObservation& o : survey.observations) {
      const auto measured = survey.measurements.find(o.line);
      const auto keyframe = slam.keyframe_of_frame(o.frame);
      if (o.name != point.name || measured == survey.measurements.end() || !measured->second.is_ok() || !keyframe) continue;
      const PixelMeasurement& pixel = measured->second.value();
      control.seen.push_back({*keyframe, static_cast<float>(pixel.normalized.x()), static_cast<float>(pixel.normalized.y()),
                              static_cast<float>(pixel.depth_m), static_cast<float>(pixel.sigma_px)});
    }
    if (!control.seen.empty()) controls.push_back(std::move(control));
  }
  return controls;
}

// A map that no point has held yet may be bent by so much: the points are there to straighten it, and do not lie for that.
double deformation_tolerance_m(const SlamResult& result) {
  Eigen::AlignedBox3d box;
  for (const StampedPose& pose : trajectory_of(result)) box.extend(pose.T_world_camera.translation);
  return std::max(kToleranceM, kDeformationPerM * box.diagonal().norm());
}

GeorefFit fit_survey(const SurveyRequest& request, const Survey& survey, const RgbdCamera& camera, const SlamResult& result,
                     double tolerance_m, std::vector<std::string>* left_out) {
  const ResolvedObservations resolved = resolve(survey, camera, result);
  *left_out = resolved.left_out;
  GeorefOptions options;
  options.tolerance_m = tolerance_m;
  options.is_excluding_suspects = request.is_excluding_suspects;
  std::vector<Rigid3> cameras;
  for (const StampedPose& pose : trajectory_of(result)) cameras.push_back(pose.T_world_camera);
  options.up_map = rough_up(cameras);
  return fit_georef(match_points(survey.points, average_measurements(resolved.measurements)), options);
}

}  // namespace

Result<GravityEstimate> find_up(const SlamResult& result, const std::vector<KeyframeSurface>& surfaces, const std::string& folder,
                                const std::string& accelerometer_path) {
  const std::string beside = (std::filesystem::path(folder) / "accelerometer.txt").string();
  if (!accelerometer_path.empty()) return up_from_accelerometer(result, accelerometer_path);
  if (auto floor = up_from_floor(result, surfaces); floor.is_ok()) return floor;
  if (std::filesystem::exists(beside)) return up_from_accelerometer(result, beside);
  return Status(ErrorCode::kNotFound, "no clear floor in view and no accelerometer.txt");
}

void level(const Eigen::Vector3d& up_map, std::uint32_t segment, SlamResult* result) {
  const Rigid3 T_level_map{shortest_turn(up_map.normalized(), Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero()};
  for (SlamPose& pose : result->poses) {
    if (pose.segment == segment) pose.T_map_camera = T_level_map * pose.T_map_camera;
  }
}

Result<Survey> read_survey(const SurveyRequest& request, const std::string& folder, const RgbdCamera& camera, double pair_ms) {
  Survey survey;
  auto points = read_control_points(request.points_path);
  if (!points.is_ok()) return points.status();
  survey.points = std::move(points).value();
  auto observations = read_control_observations(request.observed_path);
  if (!observations.is_ok()) return observations.status();
  survey.observations = std::move(observations).value();
  for (const ControlObservation& o : survey.observations) {
    if (o.kind == ObservationKind::kPixel) continue;
    return {ErrorCode::kInvalid, request.observed_path + ":" + std::to_string(o.line) +
                                     ": a build knows pixels of frames only; take this point to 'camloc map georef' afterwards"};
  }
  const std::vector<std::uint64_t> frames = frames_of(survey);
  auto source = open_frame_source(tools::with_selection(replay_url(folder) + "?pair_ms=" + tools::text_of("%.3f", pair_ms),
                                                        tools::selection_of({frames.begin(), frames.end()})));
  if (!source.is_ok()) return source.status().with_context(request.observed_path);
  const DepthLookup lookup(camera);
  const auto measure = [&](FrameBuffer& buffer) {
    measure_pixels(survey.observations, camera, lookup, buffer.view(), &survey.measurements);
    return Status::ok();
  };
  if (const auto counts = tools::read_frames(*source.value(), measure); !counts) return counts.status();
  for (const ControlObservation& o : survey.observations)
    survey.measurements.try_emplace(o.line, Status(ErrorCode::kNotFound, "the frame could not be read"));
  return survey;
}

std::vector<std::uint64_t> frames_of(const Survey& survey) {
  std::set<std::uint64_t> frames;
  for (const ControlObservation& o : survey.observations) frames.insert(o.frame);
  return {frames.begin(), frames.end()};
}

std::optional<WcsDatum> adjust_to_survey(const SurveyRequest& request, const Survey& survey, const RgbdCamera& camera, Slam* slam,
                                         SlamResult* result, GeorefSummary* summary) {
  summary->points_path = request.points_path;
  summary->observed_path = request.observed_path;
  summary->fit = fit_survey(request, survey, camera, *result, deformation_tolerance_m(*result), &summary->left_out);
  if (!summary->fit.problem.empty()) return std::nullopt;
  *result = slam->adjust_to(control_landmarks(survey, summary->fit, *slam));
  summary->fit = fit_survey(request, survey, camera, *result, kToleranceM, &summary->left_out);
  if (!summary->fit.problem.empty()) return std::nullopt;
  return summary->fit.datum;
}

}  // namespace camloc::mapping
