// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A pose regression network as a list of layers without weights. What is trained (planned_network.h) and what is written for the
// device (onnx_export.h) are both made from it, so they cannot differ.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace camloc::training {

enum class LayerKind {
  kConvolution,        ///< weights [outputs, inputs, kernel, kernel]
  kMaxPool,            ///< a window that hangs over the lower or right edge counts
  kAveragePool,        ///< whole windows only
  kGlobalAveragePool,  ///< to 1 x 1
  kLocalResponseNorm,  ///< over `kernel` channels, alpha 1e-4, beta 0.75
  kConcat,             ///< of channels
  kAdd,                ///< element by element
  kDropout,            ///< `share` of the values, in training only
  kFullyConnected,     ///< weights [outputs, all inputs]
};

inline constexpr int kImage = -1;  ///< as input of a layer

struct Layer {
  LayerKind kind = LayerKind::kConvolution;
  std::string name;
  std::vector<int> inputs;  ///< layers before this one, or kImage
  int outputs = 0;          ///< channels
  int kernel = 1, stride = 1, padding = 0;
  bool has_norm = false;  ///< batch normalization follows (and the layer has no bias)
  bool has_relu = false;  ///< comes last
  double share = 0;
};

struct LayerShape {
  int channels = 0, height = 0, width = 0;
  [[nodiscard]] int size() const { return channels * height * width; }
};

struct NetworkPlan {
  std::string name;
  LayerShape input;
  float mean = 0, scale = 1;  ///< of grey values: (v - mean) * scale
  std::vector<Layer> layers;
  std::vector<int> heads;    ///< layers with a pose each: position x y z, then quaternion w x y z; the last one is used, all are trained
  int num_trunk_layers = 0;  ///< the first ones, whose weights may come from another network

  /// Of each layer's output.
  [[nodiscard]] std::vector<LayerShape> shapes() const;
};

struct NetworkChoice {
  std::string net = "resnet";
  bool has_depth = false;
};

/// "googlenet": GoogLeNet with three regressors in place of its classifiers (Kendall, Grimes and Cipolla, "PoseNet: a convolutional
/// network for real-time 6-DOF camera relocalization", 2015), 224 x 224. "resnet": four residual blocks (He et al., "Deep residual
/// learning for image recognition", 2016) and a head that keeps where in the image things are, 128 x 96. "squeezenet": the trunk of
/// SqueezeNet 1.1 (Iandola et al., "SqueezeNet", 2016) with the same head, 224 x 168. kInvalid: another name.
[[nodiscard]] Result<NetworkPlan> plan_network(const NetworkChoice& choice);

}  // namespace camloc::training
