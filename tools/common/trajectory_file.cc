// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/trajectory_file.h"

#include <cmath>
#include <cstdio>
#include <span>
#include <sstream>

#include "core/io/file_bytes.h"
#include "core/io/sequence.h"
#include "core/io/text.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

std::string format_covariance(const Matrix6d& covariance) {
  std::string line = "# covariance";
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) line += text_of(" %.9g", covariance(row, column));
  }
  return line + "\n";
}

std::optional<Matrix6d> parse_covariance(std::istringstream& fields) {
  Matrix6d covariance;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      double value = 0;
      if (!(fields >> value) || !std::isfinite(value)) return std::nullopt;
      covariance(row, column) = covariance(column, row) = value;
    }
  }
  return covariance;
}

std::optional<Rigid3> parse_pose(std::istringstream& fields) {
  double v[7];
  for (double& value : v) {
    if (!(fields >> value) || !std::isfinite(value)) return std::nullopt;
  }
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) return std::nullopt;
  return Rigid3{rotation.normalized(), {v[0], v[1], v[2]}};
}

/// Comment lines of other programs are fine; ours must be whole.
bool parse_comment(const std::string& line, EstimatedTrajectory* trajectory, std::optional<Matrix6d>* covariance) {
  std::istringstream fields(line.substr(1));
  std::string key;
  fields >> key;
  if (key == "frames") {
    std::uint64_t count = 0;
    if (!(fields >> count)) return false;
    trajectory->num_frames = count;
  } else if (key == "covariance") {
    *covariance = parse_covariance(fields);
    return covariance->has_value();
  } else if (key == "reference_camera") {
    std::string camera;
    fields >> camera;
    trajectory->T_color_depth = parse_pose(fields);
    return trajectory->T_color_depth.has_value();
  } else if (key == "calibration") {
    std::string suspect, name;
    double scale = 1;
    if (!(fields >> suspect >> name >> scale)) return false;
    trajectory->suspect_focal_scale = scale;
  }
  return true;
}

std::string format_pose(const Rigid3& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  std::string text;
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) text += text_of(" %.9g", value);
  return text;
}

}  // namespace

std::string format_trajectory(const EstimatedTrajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw: T_map_camera of the colour camera, LOCALIZED frames only\n";
  if (trajectory.num_frames) text += "# frames " + std::to_string(*trajectory.num_frames) + "\n";
  if (trajectory.T_color_depth) text += "# reference_camera depth" + format_pose(*trajectory.T_color_depth) + "\n";
  if (trajectory.suspect_focal_scale)
    text += "# calibration suspect focal_scale " + text_of("%.9g", *trajectory.suspect_focal_scale) + "\n";
  for (const EstimatedPose& pose : trajectory.poses) {
    if (pose.covariance) text += format_covariance(*pose.covariance);
    text += format_tum_line(pose.stamp_ns, pose.T_map_camera) + "\n";
  }
  return text;
}

Result<EstimatedTrajectory> read_trajectory(const std::string& path) {
  // Poses go through the same reader as every other TUM file; comments are ours to read.
  auto poses = read_tum_trajectory(path);
  if (!poses) return poses.status();
  EstimatedTrajectory trajectory;
  const auto text = read_file_text(path);
  if (!text) return text.status();
  std::istringstream file(*text);
  std::optional<Matrix6d> covariance;
  std::size_t next_pose = 0;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line == "\r") continue;
    if (line[0] == '#') {
      if (parse_comment(line, &trajectory, &covariance)) continue;
      return {ErrorCode::kInvalid, path + ":" + std::to_string(number) + ": incomplete comment '" + line.substr(0, 40) + "'"};
    }
    if (next_pose >= poses->size()) break;
    const std::vector<std::string_view> fields = split_fields(line);
    if (fields.empty() || parse_seconds_ns(fields[0]) != (*poses)[next_pose].stamp_ns) {  // a line without a pose was left out
      covariance.reset();
      continue;
    }
    const StampedPose& pose = (*poses)[next_pose++];
    trajectory.poses.push_back({pose.stamp_ns, pose.T_world_camera, covariance});
    covariance.reset();
  }
  return trajectory;
}

}  // namespace camloc::tools
