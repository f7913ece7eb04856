// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/planned_network.h"

#include <torch/nn/functional/dropout.h>
#include <torch/nn/functional/normalization.h>
#include <torch/nn/functional/pooling.h>
#include <torch/nn/init.h>

#include <utility>

namespace camloc::training {
namespace functional = torch::nn::functional;

PlannedNetworkImpl::PlannedNetworkImpl(NetworkPlan plan) : plan_(std::move(plan)) {
  const std::vector<LayerShape> shapes = plan_.shapes();
  for (int i = 0; i < static_cast<int>(plan_.layers.size()); ++i) {
    const Layer& layer = plan_.layers[static_cast<std::size_t>(i)];
    const int input = layer.inputs.front();
    const LayerShape& from = input == kImage ? plan_.input : shapes[static_cast<std::size_t>(input)];
    if (layer.kind == LayerKind::kConvolution) {
      torch::nn::Conv2dOptions options(from.channels, layer.outputs, layer.kernel);
      options.stride(layer.stride).padding(layer.padding).bias(!layer.has_norm);
      auto& convolution = convolutions.emplace(i, register_module(layer.name, torch::nn::Conv2d(options))).first->second;
      torch::nn::init::kaiming_normal_(convolution->weight);
      if (!layer.has_norm) torch::nn::init::zeros_(convolution->bias);
      if (layer.has_norm) norms.emplace(i, register_module(layer.name + "_norm", torch::nn::BatchNorm2d(layer.outputs)));
    } else if (layer.kind == LayerKind::kFullyConnected) {
      auto& linear = linears.emplace(i, register_module(layer.name, torch::nn::Linear(from.size(), layer.outputs))).first->second;
      if (layer.has_relu) torch::nn::init::kaiming_normal_(linear->weight);
      torch::nn::init::zeros_(linear->bias);
    }
  }
}

torch::Tensor PlannedNetworkImpl::run(int index, const std::vector<torch::Tensor>& inputs) {
  const Layer& layer = plan_.layers[static_cast<std::size_t>(index)];
  const torch::Tensor& x = inputs.front();
  switch (layer.kind) {
    case LayerKind::kConvolution: {
      const torch::Tensor filtered = convolutions.at(index)->forward(x);
      return layer.has_norm ? norms.at(index)->forward(filtered) : filtered;
    }
    case LayerKind::kMaxPool:
      return functional::max_pool2d(
          x, functional::MaxPool2dFuncOptions(layer.kernel).stride(layer.stride).padding(layer.padding).ceil_mode(true));
    case LayerKind::kAveragePool: return functional::avg_pool2d(x, functional::AvgPool2dFuncOptions(layer.kernel).stride(layer.stride));
    case LayerKind::kGlobalAveragePool: return x.mean({2, 3}, true);
    case LayerKind::kLocalResponseNorm:
      return functional::local_response_norm(x, functional::LocalResponseNormFuncOptions(layer.kernel).alpha(1e-4).beta(0.75).k(1));
    case LayerKind::kConcat: return torch::cat(inputs, 1);
    case LayerKind::kAdd: return inputs[0] + inputs[1];
    case LayerKind::kDropout: return functional::dropout(x, functional::DropoutFuncOptions().p(layer.share).training(is_training()));
    case LayerKind::kFullyConnected: return linears.at(index)->forward(x.flatten(1));
  }
  return x;
}

std::vector<torch::Tensor> PlannedNetworkImpl::forward(const torch::Tensor& images) {
  std::vector<torch::Tensor> outputs;
  for (int i = 0; i < static_cast<int>(plan_.layers.size()); ++i) {
    const Layer& layer = plan_.layers[static_cast<std::size_t>(i)];
    std::vector<torch::Tensor> inputs;
    for (const int input : layer.inputs) inputs.push_back(input == kImage ? images : outputs[static_cast<std::size_t>(input)]);
    const torch::Tensor output = run(i, inputs);
    outputs.push_back(layer.has_relu ? torch::relu(output) : output);
  }
  std::vector<torch::Tensor> poses;
  for (const int head : plan_.heads) poses.push_back(outputs[static_cast<std::size_t>(head)]);
  return poses;
}

}  // namespace camloc::training
