// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A network plan as a module of libtorch. This header and whoever includes it pay for libtorch's.
#pragma once

#include <torch/nn/modules/batchnorm.h>
#include <torch/nn/modules/conv.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/pimpl.h>

#include <map>
#include <vector>

#include "tools/training/network_plan.h"

namespace camloc::training {

/// Parameters carry the names of the plan's layers. Weights are drawn as He et al. propose ("Delving deep into rectifiers", 2015) from
/// libtorch's generator.
class PlannedNetworkImpl : public torch::nn::Module {
 public:
  explicit PlannedNetworkImpl(NetworkPlan plan);

  /// [batch, channels, height, width] to one [batch, 7] for each head of the plan.
  [[nodiscard]] std::vector<torch::Tensor> forward(const torch::Tensor& images);
  [[nodiscard]] const NetworkPlan& plan() const { return plan_; }

  std::map<int, torch::nn::Conv2d> convolutions;  ///< by index of the layer
  std::map<int, torch::nn::BatchNorm2d> norms;
  std::map<int, torch::nn::Linear> linears;

 private:
  [[nodiscard]] torch::Tensor run(int index, const std::vector<torch::Tensor>& inputs);

  NetworkPlan plan_;
};
TORCH_MODULE(PlannedNetwork);

}  // namespace camloc::training
