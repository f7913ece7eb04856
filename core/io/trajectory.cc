// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses over time. A TUM file is read line by line, a 7-Scenes recording has one 4x4 matrix a frame; both become rigid
// transforms by taking the nearest rotation. pose_at() interpolates between neighbours. See sequence.h.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>

#include "core/io/file_bytes.h"
#include "core/io/left_out.h"
#include "core/io/sequence.h"
#include "core/io/text.h"

namespace camloc {

namespace {

constexpr double kMaxNormError = 0.05;      // of a quaternion; files carry four digits
constexpr double kMaxRotationError = 0.05;  // of R^T R - I; recorded files are off by 4e-4
constexpr std::int64_t kNearestNs = 500'000;
constexpr double kMaxGapNs = 1e8;  // between the poses that are interpolated

/// 4x4 row-major, camera to world. Non-finite numbers mark a frame without a pose in some recordings.
Result<std::optional<Rigid3>> read_pose_matrix(const std::string& path) {
  Result<std::string> text = read_file_text(path, 1 << 16);
  if (!text) return text.status();
  const std::vector<std::string_view> fields = split_fields(*text, " \t\r\n,");
  if (fields.size() != 16)
    return Status(ErrorCode::kInvalid, path + ": " + std::to_string(fields.size()) + " numbers, expected a 4x4 matrix");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    const std::string_view field = fields[static_cast<std::size_t>(i)];
    const std::optional<double> value = is_missing_number(field) ? std::numeric_limits<double>::quiet_NaN() : parse_double(field);
    if (!value) return Status(ErrorCode::kInvalid, path + ": " + in_quotes(fields[static_cast<std::size_t>(i)]) + " is not a number");
    matrix(i / 4, i % 4) = *value;
  }
  if (!matrix.allFinite()) return std::optional<Rigid3>();
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  const bool is_rigid = error <= kMaxRotationError && rotation.determinant() > 0 &&
                        (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < 1e-6;
  if (!is_rigid) return Status(ErrorCode::kInvalid, path + ": not a rigid transform (rotation, translation, last row 0 0 0 1)");
  return std::optional<Rigid3>(Rigid3{nearest_rotation(rotation), matrix.topRightCorner<3, 1>()});
}

std::string pose_path_of(const SequenceFrame& frame, bool is_scannet) {
  const std::filesystem::path color(frame.color_path);
  if (is_scannet) return (color.parent_path().parent_path() / "pose" / (color.stem().string() + ".txt")).string();
  const std::size_t suffix = frame.color_path.rfind(".color.");
  return frame.color_path.substr(0, suffix) + ".pose.txt";
}

Result<std::vector<std::optional<Rigid3>>> read_pose_matrices(const Sequence& sequence) {
  std::vector<std::optional<Rigid3>> poses;
  bool has_any_file = false;
  for (const SequenceFrame& frame : sequence.frames) {
    Result<std::optional<Rigid3>> T_world_camera = read_pose_matrix(pose_path_of(frame, sequence.layout == "scannet"));
    if (!T_world_camera && T_world_camera.status().code() != ErrorCode::kNotFound) return T_world_camera.status();
    has_any_file = has_any_file || T_world_camera.is_ok();
    poses.push_back(T_world_camera ? *T_world_camera : std::nullopt);
  }
  if (!has_any_file)
    return Status(ErrorCode::kNotFound, sequence.folder + ": no frame-*.pose.txt (or pose/N.txt), the recording has no poses of its own");
  return poses;
}

bool has_no_pose(const std::vector<std::string_view>& fields) {
  if (std::any_of(fields.begin(), fields.end(), is_missing_number)) return true;
  return fields.size() == 8 && std::all_of(fields.begin() + 4, fields.end(), [](std::string_view f) { return parse_double(f) == 0.0; });
}

/// Makes comments of the lines without a pose.
LeftOut leave_out_lines_without_pose(std::string* text) {
  LeftOut left_out;
  for (const TextLine& line : content_lines(*text)) {
    if (!has_no_pose(split_fields(line.text))) continue;
    left_out.add(line.number);
    (*text)[static_cast<std::size_t>(line.text.data() - text->data())] = '#';
  }
  return left_out;
}

}  // namespace

Result<std::vector<StampedPose>> read_tum_trajectory(const std::string& path, std::vector<std::string>* notes) {
  Result<std::string> text = read_file_text(path);
  if (!text) return text.status();
  const LeftOut left_out = leave_out_lines_without_pose(&*text);
  left_out.note(path, "line", "without a pose (nan, infinite, or a quaternion of zeros)", notes);
  std::vector<StampedPose> poses;
  const auto add = [&poses](std::int64_t stamp_ns, std::span<const double> v) -> Status {
    Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    if (!(std::abs(rotation.norm() - 1) <= kMaxNormError)) return {ErrorCode::kInvalid, "the quaternion is not of unit length"};
    rotation.normalize();
    poses.push_back({stamp_ns, {rotation, {v[0], v[1], v[2]}}});
    return Status::ok();
  };
  constexpr double kLargest = std::numeric_limits<double>::max();
  if (Status status = read_stamped_rows(*text, path, "timestamp tx ty tz qx qy qz qw", "a number", kLargest, add); !status) return status;
  if (poses.empty() && left_out.count > 0) {
    return line_error(path, left_out.first_line, "no pose (nan, infinite, or a quaternion of zeros), and no other line has one");
  }
  return poses;
}

std::string format_tum_line(std::int64_t stamp_ns, const Rigid3& T_map_camera) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  std::string line = stamp_ns < 0 ? "-" : "";
  const std::uint64_t magnitude = stamp_ns < 0 ? 0 - static_cast<std::uint64_t>(stamp_ns) : static_cast<std::uint64_t>(stamp_ns);
  const std::string fraction = std::to_string(magnitude % kNsPerSecond);
  line += std::to_string(magnitude / kNsPerSecond) + "." + std::string(9 - fraction.size(), '0') + fraction;
  const Eigen::Vector3d& t = T_map_camera.translation;
  const Eigen::Quaterniond& q = T_map_camera.rotation;
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    char text[400];  // enough for the largest double
    line += ' ';
    line.append(text, std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed, 9).ptr);
  }
  return line;
}

std::optional<Rigid3> pose_at(const std::vector<StampedPose>& trajectory, std::int64_t stamp_ns) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                                      [](const StampedPose& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after != trajectory.end() && after->stamp_ns == stamp_ns) return after->T_world_camera;
  const bool has_after = after != trajectory.end();
  const bool has_before = after != trajectory.begin();
  if (has_before && has_after) {
    const StampedPose& before = *(after - 1);
    const auto gap_ns = static_cast<double>(after->stamp_ns - before.stamp_ns);
    if (gap_ns <= kMaxGapNs) {
      return interpolate(before.T_world_camera, after->T_world_camera, static_cast<double>(stamp_ns - before.stamp_ns) / gap_ns);
    }
  }
  const std::int64_t to_before_ns = has_before ? stamp_ns - (after - 1)->stamp_ns : kNearestNs + 1;
  const std::int64_t to_after_ns = has_after ? after->stamp_ns - stamp_ns : kNearestNs + 1;
  if (std::min(to_before_ns, to_after_ns) > kNearestNs) return std::nullopt;
  return to_before_ns <= to_after_ns ? (after - 1)->T_world_camera : after->T_world_camera;
}

Result<std::vector<std::optional<Rigid3>>> read_embedded_poses(const Sequence& sequence, std::vector<std::string>* notes) {
  if (sequence.layout != "tum") return read_pose_matrices(sequence);
  const std::string path = (std::filesystem::path(sequence.folder) / "groundtruth.txt").string();
  Result<std::vector<StampedPose>> trajectory = read_tum_trajectory(path, notes);
  if (!trajectory && trajectory.status().code() == ErrorCode::kNotFound) {
    return Status(ErrorCode::kNotFound, path + ": missing, the recording has no poses of its own");
  }
  if (!trajectory) return trajectory.status();
  std::vector<std::optional<Rigid3>> poses;
  for (const SequenceFrame& frame : sequence.frames) poses.push_back(pose_at(*trajectory, frame.stamp_ns));
  return poses;
}

}  // namespace camloc
