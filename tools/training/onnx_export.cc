// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/onnx_export.h"

#include <torch/autograd.h>
#include <torch/utils.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

namespace camloc::training {
namespace {

std::vector<float> values_of(const torch::Tensor& tensor) {
  const torch::Tensor flat = tensor.detach().to(torch::kFloat32).contiguous();
  return {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()};
}

OnnxTensor tensor_of(const std::string& name, const torch::Tensor& tensor) { return {name, tensor.sizes().vec(), values_of(tensor)}; }

std::vector<std::int64_t> twice(std::int64_t value) { return {value, value}; }

class Exporter {
 public:
  Exporter(PlannedNetwork* network, const PositionScale& scale) : network_(network), plan_((*network)->plan()), scale_(scale) {}

  OnnxModel model() {
    mark_needed(plan_.heads.back());
    const LayerShape& in = plan_.input;
    out_.producer = "camloc";
    out_.inputs = {{"image", {1, in.channels, in.height, in.width}}};
    out_.outputs = {{"pose", {1, 7}}};
    for (const int index : needed_) add(index);
    return std::move(out_);
  }

 private:
  void mark_needed(int index) {
    if (index == kImage || !needed_.insert(index).second) return;
    for (const int input : layer(index).inputs) mark_needed(input);
  }
  const Layer& layer(int index) const { return plan_.layers[static_cast<std::size_t>(index)]; }
  LayerShape shape(int index) const { return index == kImage ? plan_.input : shapes_[static_cast<std::size_t>(index)]; }
  std::string value_name(int index) const {
    if (index == kImage) return "image";
    if (index == plan_.heads.back()) return "pose";
    return layer(index).kind == LayerKind::kDropout ? value_name(layer(index).inputs.front()) : layer(index).name;
  }

  /// A node whose result becomes the layer's; its rectifier, where the layer has one, is the node after it.
  void finish(int index, OnnxNode node) {
    const std::string result = value_name(index);
    node.name = layer(index).name;
    node.outputs = {layer(index).has_relu ? result + "_linear" : result};
    out_.nodes.push_back(std::move(node));
    if (layer(index).has_relu) out_.nodes.push_back({"Relu", layer(index).name + "_relu", {result + "_linear"}, {result}, {}});
  }

  void add_convolution(int index) {
    const Layer& of = layer(index);
    auto& convolution = (*network_)->convolutions.at(index);
    torch::Tensor weight = convolution->weight, bias = convolution->bias;
    if (of.has_norm) {
      auto& norm = (*network_)->norms.at(index);
      const torch::Tensor gain = norm->weight / torch::sqrt(norm->running_var + norm->options.eps());
      weight = weight * gain.view({-1, 1, 1, 1});
      bias = norm->bias - norm->running_mean * gain;
    }
    out_.weights.push_back(tensor_of(of.name + "_weight", weight));
    out_.weights.push_back(tensor_of(of.name + "_bias", bias));
    const std::int64_t pad = of.padding;
    finish(index, {"Conv",
                   "",
                   {value_name(of.inputs.front()), of.name + "_weight", of.name + "_bias"},
                   {},
                   {{"kernel_shape", twice(of.kernel)},
                    {"strides", twice(of.stride)},
                    {"pads", std::vector<std::int64_t>{pad, pad, pad, pad}},
                    {"dilations", twice(1)},
                    {"group", std::int64_t{1}}}});
  }

  void add_pool(int index, const char* op) {
    const Layer& of = layer(index);
    const LayerShape from = shape(of.inputs.front()), to = shape(index);
    // Opset 9 does not round up: what hangs over is padding.
    const auto end = [&](int size, int pooled) {
      return std::int64_t{std::max(of.padding, (pooled - 1) * of.stride + of.kernel - size - of.padding)};
    };
    const std::vector<std::int64_t> pads{of.padding, of.padding, end(from.height, to.height), end(from.width, to.width)};
    finish(
        index,
        {op, "", {value_name(of.inputs.front())}, {}, {{"kernel_shape", twice(of.kernel)}, {"strides", twice(of.stride)}, {"pads", pads}}});
  }

  void add_fully_connected(int index) {
    const Layer& of = layer(index);
    auto& linear = (*network_)->linears.at(index);
    torch::Tensor weight = linear->weight.detach().clone(), bias = linear->bias.detach().clone();
    if (index == plan_.heads.back()) {
      for (int axis = 0; axis < 3; ++axis) {
        weight[axis] *= scale_.deviation_m;
        bias[axis] = bias[axis] * scale_.deviation_m + scale_.mean_m[axis];
      }
    }
    out_.weights.push_back(tensor_of(of.name + "_weight", weight));
    out_.weights.push_back(tensor_of(of.name + "_bias", bias));
    std::string input = value_name(of.inputs.front());
    if (const LayerShape from = shape(of.inputs.front()); from.height * from.width > 0 && layer(index).inputs.front() != kImage) {
      out_.nodes.push_back({"Flatten", of.name + "_flat", {input}, {of.name + "_flat"}, {{"axis", std::int64_t{1}}}});
      input = of.name + "_flat";
    }
    finish(index, {"Gemm",
                   "",
                   {input, of.name + "_weight", of.name + "_bias"},
                   {},
                   {{"alpha", 1.0F}, {"beta", 1.0F}, {"transA", std::int64_t{0}}, {"transB", std::int64_t{1}}}});
  }

  void add(int index) {
    const Layer& of = layer(index);
    std::vector<std::string> inputs;
    for (const int input : of.inputs) inputs.push_back(value_name(input));
    switch (of.kind) {
      case LayerKind::kConvolution: return add_convolution(index);
      case LayerKind::kMaxPool: return add_pool(index, "MaxPool");
      case LayerKind::kAveragePool: return add_pool(index, "AveragePool");
      case LayerKind::kGlobalAveragePool: return finish(index, {"GlobalAveragePool", "", inputs, {}, {}});
      case LayerKind::kLocalResponseNorm:
        return finish(index,
                      {"LRN", "", inputs, {}, {{"alpha", 1e-4F}, {"beta", 0.75F}, {"bias", 1.0F}, {"size", std::int64_t{of.kernel}}}});
      case LayerKind::kConcat: return finish(index, {"Concat", "", inputs, {}, {{"axis", std::int64_t{1}}}});
      case LayerKind::kAdd: return finish(index, {"Add", "", inputs, {}, {}});
      case LayerKind::kDropout: return;  // for training
      case LayerKind::kFullyConnected: return add_fully_connected(index);
    }
  }

  PlannedNetwork* network_;
  const NetworkPlan& plan_;
  PositionScale scale_;
  std::vector<LayerShape> shapes_ = plan_.shapes();
  std::set<int> needed_;
  OnnxModel out_;
};

std::string text_of(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t size : shape) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text;
}

/// Weights and biases of the convolutions of a model, in the order of its nodes.
struct Filters {
  std::string name;
  const OnnxTensor* weight = nullptr;
  const OnnxTensor* bias = nullptr;
};
std::vector<Filters> convolutions_of(const OnnxModel& model) {
  std::vector<Filters> found;
  const auto tensor = [&](const std::string& name) {
    const auto at = std::find_if(model.weights.begin(), model.weights.end(), [&](const OnnxTensor& of) { return of.name == name; });
    return at == model.weights.end() ? nullptr : &*at;
  };
  for (const OnnxNode& node : model.nodes) {
    if (node.op != "Conv" || node.inputs.size() < 2) continue;
    found.push_back({node.name.empty() ? node.inputs[1] : node.name, tensor(node.inputs[1]),
                     node.inputs.size() > 2 ? tensor(node.inputs[2]) : nullptr});
  }
  return found;
}

/// [outputs, channels, ...] with as many channels of zeros behind as the network has more.
torch::Tensor widened(const OnnxTensor& weight, std::int64_t num_channels) {
  torch::Tensor values = torch::tensor(weight.values).view(weight.shape);
  if (weight.shape[1] >= num_channels) return values;
  std::vector<std::int64_t> missing = weight.shape;
  missing[1] = num_channels - weight.shape[1];
  return torch::cat({values, torch::zeros(missing)}, 1);
}

}  // namespace

OnnxModel to_onnx(PlannedNetwork& network, const PositionScale& scale) {
  const torch::NoGradGuard no_gradients;
  return Exporter(&network, scale).model();
}

Status initialize_trunk(const OnnxModel& model, PlannedNetwork* network) {
  const torch::NoGradGuard no_gradients;
  const std::vector<Filters> given = convolutions_of(model);
  std::vector<std::pair<int, torch::Tensor>> fitting;
  for (const auto& [index, convolution] : (*network)->convolutions) {
    if (index >= (*network)->plan().num_trunk_layers) break;
    const std::string& name = (*network)->plan().layers[static_cast<std::size_t>(index)].name;
    if ((*network)->plan().layers[static_cast<std::size_t>(index)].has_norm)
      return {ErrorCode::kInvalid, "weights of another model serve networks without batch normalization: squeezenet, googlenet"};
    if (fitting.size() >= given.size())
      return {ErrorCode::kInvalid,
              "the model has " + std::to_string(given.size()) + " convolutions; the network's " + name + " finds none"};
    const Filters& from = given[fitting.size()];
    std::vector<std::int64_t> wanted = convolution->weight.sizes().vec();
    if (from.weight == nullptr) return {ErrorCode::kInvalid, "the weights of '" + from.name + "' are not in the model as float32"};
    const bool is_first_with_depth = fitting.empty() && from.weight->shape.size() == 4 && from.weight->shape[1] + 1 == wanted[1];
    if (is_first_with_depth) --wanted[1];
    if (from.weight->shape != wanted)
      return {ErrorCode::kInvalid, "the weights of '" + from.name + "' are " + text_of(from.weight->shape) + ", but the network's " + name +
                                       " has " + text_of(wanted)};
    fitting.emplace_back(index, widened(*from.weight, convolution->weight.size(1)));
  }
  for (std::size_t i = 0; i < fitting.size(); ++i) {
    auto& convolution = (*network)->convolutions.at(fitting[i].first);
    convolution->weight.copy_(fitting[i].second);
    if (given[i].bias != nullptr && static_cast<std::int64_t>(given[i].bias->values.size()) == convolution->bias.numel())
      convolution->bias.copy_(torch::tensor(given[i].bias->values));
  }
  return Status::ok();
}

}  // namespace camloc::training
