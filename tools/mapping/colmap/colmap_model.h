// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A COLMAP model in its text form: cameras.txt, images.txt, points3D.txt (Schoenberger and Frahm, "Structure-from-Motion
// Revisited", 2016). Values stay in COLMAP's conventions here: world-to-camera, quaternions w x y z, the centre of the first
// pixel at (0.5, 0.5), units of an unknown scale. Whoever uses them converts; kColmapPixelShift is the step between the
// two pixel conventions. Binary models are not read.
//
// With it, the poses of a recording's frames where the model was made of its colour images (colmap_poses.cc). How many metres a unit
// is, images alone do not tell: the depth that was recorded with them does (colmap_scale.cc).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/io/sequence.h"

namespace camloc::mapping {

/// COLMAP pixel = ours + this, in both directions of the image.
inline constexpr double kColmapPixelShift = 0.5;

struct ColmapCamera {
  std::uint32_t id = 0;
  std::string model;  ///< PINHOLE, OPENCV, ...
  int width = 0, height = 0;
  std::vector<double> parameters;
};

/// A keypoint of an image that belongs to a point.
struct ColmapObservation {
  double u = 0, v = 0;      ///< COLMAP's pixels
  std::uint32_t point = 0;  ///< index into ColmapModel::points
};

struct ColmapImage {
  std::uint32_t id = 0;
  std::uint32_t camera_id = 0;
  Rigid3 T_camera_world;
  std::string name;
  std::vector<ColmapObservation> observations;  ///< keypoints without a point are left out
};

struct ColmapPoint {
  std::uint64_t id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::array<std::uint8_t, 3> rgb{};
};

struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;
};

/// The intrinsics as COLMAP writes them: PINHOLE, OPENCV, FULL_OPENCV (with k3) or OPENCV_FISHEYE.
[[nodiscard]] ColmapCamera to_colmap(const Intrinsics& intrinsics, std::uint32_t id);

/// Reads the three files of a folder. Every reference between them is checked. Errors name file and line: kNotFound (a file is
/// missing, or only a binary model is there), kInvalid (field counts, numbers, identifiers).
[[nodiscard]] Result<ColmapModel> read_colmap_model(const std::string& folder);

/// Makes the folder where it does not exist (its parent must) and replaces the three files, each as a whole. Ids count from 1
/// in the order of `points`; ids in `model.points` are not used. `comment` is put into each file. kInvalid where the folder
/// holds a binary model, which COLMAP would read in place of this one; kIo where the system refuses.
[[nodiscard]] Status write_colmap_model(const ColmapModel& model, const std::string& folder, const std::string& comment);

/// A point of the model as one image sees it.
struct DepthPair {
  std::uint32_t image = 0;      ///< which; numbers are only compared
  double model_depth = 0;       ///< along the optical axis, units of the model, > 0
  double measured_depth_m = 0;  ///< by the depth camera at the same pixel, > 0
};

struct ModelScale {
  double metres_per_unit = 1;
  double spread = 0;        ///< of single ratios, one robust standard deviation, relative
  double image_spread = 0;  ///< the same of the images' medians: drift of scale within the model
  std::uint64_t num_pairs = 0, num_images = 0;
};

/// "0.271 m a unit, from 80170 points in 60 images; scatter 1.2 %, drift between images 0.4 %": for a summary.
[[nodiscard]] std::string describe_scale(const ModelScale& scale);

/// Median of measured / model depth. The spreads are 1.4826 times the median absolute deviation of the logarithm of the ratio.
/// kInvalid, naming the numbers: too few pairs, or spreads above the limits, as with poses, images or a depth that do not
/// belong together.
[[nodiscard]] Result<ModelScale> estimate_model_scale(std::span<const DepthPair> pairs);

struct ColmapPoses {
  std::vector<std::optional<Rigid3>> T_map_camera;  ///< of the colour camera, per frame of the recording; metres
  ModelScale scale;
  std::vector<std::string> notes;  ///< what was left out, and where the model's lens is not the camera file's: a line each
};

/// Reads the model, matches names, measures its scale at up to 60 images evenly over the recording, and turns poses into
/// metres. The map's frame is the model's, scaled. Images of the model that are none of the recording are left out. Errors: those of
/// read_colmap_model and estimate_model_scale; kInvalid, naming the image: no name that a frame has, one that several frames have (folders
/// in front do not count), or that two images have; another image size than the camera's.
[[nodiscard]] Result<ColmapPoses> read_colmap_poses(const std::string& folder, const Sequence& sequence, const RgbdCamera& camera);

}  // namespace camloc::mapping
