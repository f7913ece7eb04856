// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A network that is small enough to work out by hand: the mean of each channel, and from these a pose by one matrix.
#pragma once

#include "core/coarse/coarse_model.h"

namespace camloc {

inline CoarseModelInfo sample_coarse_info() {
  CoarseModelInfo info;
  info.map_id = "00000000000000ab";
  info.layout = {2, 16, 12, 14.5F, 127.5F, 1.0F / 64};
  info.net = "mean";
  info.training = "kitchen, frames 0 to 99";
  info.num_training_frames = 100;
  info.sigma_position_m = 0.25;
  info.sigma_rotation_rad = 0.125;
  info.train_fx = 525, info.train_fy = 525.5F;
  info.train_width = 640, info.train_height = 480;
  return info;
}

/// pose = bias + mean of channel 0 * (0.5, 0, -1, 0, 0, 0, 0) + mean of channel 1 * (0, 2, 0, 0, 0, 0, 0)
inline OnnxModel sample_onnx(const CoarseModelInfo& info = sample_coarse_info()) {
  const auto channels = static_cast<std::size_t>(info.layout.channels);
  OnnxModel model;
  model.producer = "camloc";
  model.inputs = {{"image", {1, info.layout.channels, info.layout.height, info.layout.width}}};
  model.outputs = {{"pose", {1, 7}}};
  model.nodes = {{"GlobalAveragePool", "pool", {"image"}, {"pooled"}, {}},
                 {"Flatten", "flatten", {"pooled"}, {"means"}, {{"axis", std::int64_t{1}}}},
                 {"Gemm", "head", {"means", "head_w", "head_b"}, {"pose"}, {{"transB", std::int64_t{1}}}}};
  std::vector<float> matrix(7 * channels, 0.0F);
  matrix[0] = 0.5F;
  matrix[2 * channels] = -1;
  if (channels > 1) matrix[channels + 1] = 2;
  model.weights = {{"head_w", {7, info.layout.channels}, matrix}, {"head_b", {7}, {1, 2, 3, 2, 0, 0, 0}}};
  set_coarse_info(info, &model);
  return model;
}

}  // namespace camloc
