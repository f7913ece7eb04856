// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A trained network as an ONNX model of opset 9, and weights of another model into a network that has not been trained.
#pragma once

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/coarse/onnx_file.h"
#include "tools/training/planned_network.h"

namespace camloc::training {

/// What the network's position output is multiplied by and added to, to be metres in the map.
struct PositionScale {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  double deviation_m = 1;
};

/// The part of the network that leads to the last head, normalization folded into the convolutions and the position's scale into the last
/// layer. Input "image" [1, channels, height, width], output "pose" [1, 7]: metres, then a quaternion w x y z of any length.
[[nodiscard]] OnnxModel to_onnx(PlannedNetwork& network, const PositionScale& scale);

/// Gives the trunk's convolutions the weights of those of `model`, in order. kInvalid where their shapes do not fit, with the first that
/// does not; the network is as it was then. Weights for images with fewer channels serve where only the depth is new: it starts at zero.
[[nodiscard]] Status initialize_trunk(const OnnxModel& model, PlannedNetwork* network);

}  // namespace camloc::training
