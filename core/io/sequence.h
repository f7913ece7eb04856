// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Index of a recorded RGB-D sequence on disk: TUM RGB-D (rgb.txt, depth.txt, groundtruth.txt) or 7-Scenes
// (frame-NNNNNN.color.*, .depth.png, .pose.txt). Reads no pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/gravity.h"
#include "core/geometry/rigid3.h"

namespace camloc {

struct SequenceFrame {
  std::uint64_t index = 0;  ///< position in the whole recording, before any selection
  std::int64_t stamp_ns = 0;
  std::string color_path;
  std::string depth_path;  ///< empty: no depth within the association window
};

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Rigid3 T_world_camera;  ///< as recorded; nearest rotation taken
};

struct Sequence {
  std::string folder;
  std::string layout;                 ///< "tum" or "7scenes"
  std::vector<SequenceFrame> frames;  ///< ascending in time
};

/// Errors name file and line. Unsorted stamps, missing images and an empty folder are errors; a colour image without a
/// depth image within 20 ms is not. Depth belongs to the colour image nearest in time, one to one. 7-Scenes has no
/// stamps: frame NNNNNN gets NNNNNN / frame_rate_hz seconds.
[[nodiscard]] Result<Sequence> read_sequence(const std::string& folder, double frame_rate_hz = 30);

/// Poses recorded with the sequence (groundtruth.txt or .pose.txt), interpolated at the frame's stamp where the neighbours
/// are at most 0.1 s apart; nullopt where there is none. Same length as sequence.frames. kNotFound where the recording
/// has no poses at all.
[[nodiscard]] Result<std::vector<std::optional<Rigid3>>> read_embedded_poses(const Sequence& sequence);

/// Trajectory file in TUM format: "timestamp tx ty tz qx qy qz qw", seconds, '#' comments, ascending stamps.
[[nodiscard]] Result<std::vector<StampedPose>> read_tum_trajectory(const std::string& path);
/// One such line with stamp to the nanosecond, without line end.
[[nodiscard]] std::string format_tum_line(std::int64_t stamp_ns, const Rigid3& T_map_camera);

/// Pose at a time from an ordered trajectory: interpolated between neighbours at most 0.1 s apart, or the nearest
/// within 0.5 ms.
[[nodiscard]] std::optional<Rigid3> pose_at(const std::vector<StampedPose>& trajectory, std::int64_t stamp_ns);

/// Which frames of a recording: "start:stop:step[,...]" by Python's slice rules on the frame index. Ascending indices below
/// `num_frames` that `include` (empty = all) names and `exclude` (empty = none) does not.
[[nodiscard]] Result<std::vector<std::size_t>> select_frames(const std::string& include, const std::string& exclude,
                                                             std::size_t num_frames);

// Accelerometer files beside a recording: TUM RGB-D's accelerometer.txt, "timestamp ax ay az" in seconds and m/s^2 (or g). The benchmark
// does not say which way the axes point; see kinect_R_camera_accelerometer() in core/geometry/gravity.h.
struct AccelerometerSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< m/s^2, axes of the sensor; at rest it points up
};

/// Readings of length about 1 are taken as multiples of standard gravity. Stamps ascend. Errors name file and line; kInvalid
/// also where the typical length is neither that of m/s^2 nor of g.
[[nodiscard]] Result<std::vector<AccelerometerSample>> read_accelerometer(const std::string& path);

/// The readings at whose time the camera has a pose (pose_at), with its orientation.
[[nodiscard]] std::vector<OrientedReading> with_orientations(const std::vector<AccelerometerSample>& samples,
                                                             const std::vector<StampedPose>& trajectory);

}  // namespace camloc
