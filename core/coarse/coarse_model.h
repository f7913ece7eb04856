// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A network that says where in one map a frame was taken, to decimetres or metres: an ONNX file whose metadata (keys "camloc.*") says
// for which map, what it sees and how far it is off. What it is off is a measurement of who trained it and no promise.
//
//   input   1 x C x H x W floats, as NetworkInput makes them
//   output  1 x 7 floats: x y z of the camera in the map, metres, then qw qx qy qz of T_map_camera, not normalized
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/coarse/network_input.h"
#include "core/coarse/onnx_file.h"
#include "core/geometry/rigid3.h"

namespace camloc {

inline constexpr std::size_t kCoarseOutputSize = 7;

struct CoarseModelInfo {
  std::string map_id;  ///< 16 hexadecimal digits, as `camloc map info` prints it
  NetworkInputLayout layout;
  std::string net;       ///< its structure, "resnet" for example
  std::string training;  ///< in free text: recordings and frames that it was trained on
  std::uint32_t num_training_frames = 0;
  double sigma_position_m = 0;       ///< standard deviation along one axis, on frames held out in training
  double sigma_rotation_rad = 0;     ///< the same about one axis
  float train_fx = 0, train_fy = 0;  ///< of the camera that took the training frames, pixels
  int train_width = 0, train_height = 0;
};

struct CoarseModel {
  OnnxModel onnx;
  CoarseModelInfo info;
};

/// How a map's id is written in models and by the programs.
[[nodiscard]] std::string map_id_text(std::uint64_t map_id);

/// Puts `info` into the model's metadata; other keys stay.
void set_coarse_info(const CoarseModelInfo& info, OnnxModel* model);

/// The model's metadata, checked: every key there, every number finite and in its range, one input 1xCxHxW and one output 1x7 in the
/// graph that say the same, all weights finite. kInvalid names the key.
[[nodiscard]] Result<CoarseModelInfo> coarse_info_of(const OnnxModel& model);

/// read_onnx and coarse_info_of; messages name the file.
[[nodiscard]] Result<CoarseModel> read_coarse_model(const std::string& path);

/// kInvalid with both ids where the model is for another map.
[[nodiscard]] Status check_coarse_map(const CoarseModelInfo& info, std::uint64_t map_id);

/// T_map_camera from the network's output; nothing where a number is not finite or the quaternion is almost zero.
[[nodiscard]] std::optional<Rigid3> coarse_pose(std::span<const float> output);

/// Covariance of pose_error() for a pose of this model.
[[nodiscard]] Matrix6d coarse_covariance(const CoarseModelInfo& info);

}  // namespace camloc
