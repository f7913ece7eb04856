// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Index of a recorded RGB-D sequence on disk: TUM RGB-D (rgb.txt, depth.txt, groundtruth.txt), pairs in associations.txt as ICL-NUIM and
// ORB-SLAM have them, 7-Scenes (frame-NNNNNN.color.*, .depth.png, .pose.txt) or ScanNet (color/N.jpg, depth/N.png, pose/N.txt). Reads
// no pixels.
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
  std::string layout;                 ///< "tum", "7scenes" or "scannet"
  std::vector<SequenceFrame> frames;  ///< ascending in time
  std::vector<std::string> notes;     ///< what was left out or remains without depth, for people: a line each
};

struct SequenceOptions {
  double frame_rate_hz = 30;  ///< where frames have numbers instead of stamps
  double pair_ms = 20;        ///< how far a colour image and its depth image may be apart; TUM's own tools take the same
};

/// Errors name file and line. Unsorted stamps, missing images and an empty folder are errors; a colour image without a
/// depth image within pair_ms is not. Depth belongs to the colour image nearest in time, one to one. An image with the stamp of the one
/// before is left out. 7-Scenes and ScanNet have no stamps: frame N gets N / frame_rate_hz seconds.
[[nodiscard]] Result<Sequence> read_sequence(const std::string& folder, const SequenceOptions& options = {});

// Layouts behind read_sequence() that have a file of their own (sequence_layouts.cc).

/// Whether `folder` has the layout.
[[nodiscard]] bool has_associations(const std::string& folder);
[[nodiscard]] bool has_scannet_layout(const std::string& folder);

/// associations.txt: "stamp file stamp file" a line, colour and depth in either order. Which is depth, the first line tells: the 16-bit
/// grey PNG, else the one with "depth" in its name. Pairs are taken as they are written, at the colour image's stamp.
[[nodiscard]] Result<Sequence> read_associations(const std::string& folder, const SequenceOptions& options);
/// color/N.jpg (or png), depth/N.png.
[[nodiscard]] Result<Sequence> read_scannet(const std::string& folder, const SequenceOptions& options);

/// Poses recorded with the sequence (groundtruth.txt or .pose.txt), interpolated at the frame's stamp where the neighbours
/// are at most 0.1 s apart; nullopt where there is none. Same length as sequence.frames. kNotFound where the recording
/// has no poses at all.
[[nodiscard]] Result<std::vector<std::optional<Rigid3>>> read_embedded_poses(const Sequence& sequence,
                                                                             std::vector<std::string>* notes = nullptr);

/// Trajectory file in TUM format: "timestamp tx ty tz qx qy qz qw", seconds, '#' comments, ascending stamps. Lines without a pose (a number
/// that is nan or infinite, in any program's spelling, or a quaternion of zeros), as motion capture writes them, are left out; `notes`
/// gets a line that counts them and names the first. kInvalid where no other line is left.
[[nodiscard]] Result<std::vector<StampedPose>> read_tum_trajectory(const std::string& path, std::vector<std::string>* notes = nullptr);
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
