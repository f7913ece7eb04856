// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A COLMAP model in its text form: cameras.txt, images.txt, points3D.txt (Schoenberger and Frahm, "Structure-from-Motion
// Revisited", 2016). Values stay in COLMAP's conventions here: world-to-camera, quaternions w x y z, the centre of the first
// pixel at (0.5, 0.5), units of an unknown scale. Whoever uses them converts; kColmapPixelShift is the step between the
// two pixel conventions. Binary models are not read.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

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

}  // namespace camloc::mapping
