// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The three networks. Each function below adds layers and returns the index of the last one, so that a network reads from its input
// to its output.
#include "tools/training/network_plan.h"

#include <initializer_list>
#include <utility>

namespace camloc::training {
namespace {

constexpr int kPoseValues = 7;
/// The mean of photographs, grey levels, and their standard deviation.
constexpr float kMeanGray = 115, kGrayDeviation = 58;

class Drawing {
 public:
  explicit Drawing(NetworkPlan* plan) : plan_(plan) {}

  int add(Layer layer) {
    plan_->layers.push_back(std::move(layer));
    return static_cast<int>(plan_->layers.size()) - 1;
  }
  int convolution(const std::string& name, int input, int outputs, int kernel, int stride = 1, int padding = 0) {
    return add(
        {.name = name, .inputs = {input}, .outputs = outputs, .kernel = kernel, .stride = stride, .padding = padding, .has_relu = true});
  }
  int normed(const std::string& name, int input, int outputs, int kernel, int stride, bool has_relu) {
    return add({.name = name,
                .inputs = {input},
                .outputs = outputs,
                .kernel = kernel,
                .stride = stride,
                .padding = kernel / 2,
                .has_norm = true,
                .has_relu = has_relu});
  }
  int max_pool(const std::string& name, int input, int kernel, int stride, int padding = 0) {
    return add({.kind = LayerKind::kMaxPool, .name = name, .inputs = {input}, .kernel = kernel, .stride = stride, .padding = padding});
  }
  int average_pool(const std::string& name, int input, int kernel, int stride) {
    return add({.kind = LayerKind::kAveragePool, .name = name, .inputs = {input}, .kernel = kernel, .stride = stride});
  }
  int response_norm(const std::string& name, int input) {
    return add({.kind = LayerKind::kLocalResponseNorm, .name = name, .inputs = {input}, .kernel = 5});
  }
  int concat(const std::string& name, std::vector<int> inputs) {
    return add({.kind = LayerKind::kConcat, .name = name, .inputs = std::move(inputs)});
  }
  int dropout(const std::string& name, int input, double share) {
    return add({.kind = LayerKind::kDropout, .name = name, .inputs = {input}, .share = share});
  }
  int fully_connected(const std::string& name, int input, int outputs, bool has_relu) {
    return add({.kind = LayerKind::kFullyConnected, .name = name, .inputs = {input}, .outputs = outputs, .has_relu = has_relu});
  }
  /// The pose, and what leads to it.
  void head(const std::string& name, int input, int hidden, double share) {
    const int features = fully_connected(name + "_features", input, hidden, true);
    plan_->heads.push_back(fully_connected(name, dropout(name + "_dropout", features, share), kPoseValues, false));
  }
  void end_of_trunk() { plan_->num_trunk_layers = static_cast<int>(plan_->layers.size()); }

 private:
  NetworkPlan* plan_;
};

/// Where something is in the image says how the camera stands: unlike a classifier's, this head does not average that away.
void head_with_places(Drawing* draw, int input) { draw->head("pose", draw->convolution("squeeze", input, 32, 1), 256, 0.2); }

/// Numbers of channels of an inception module: 1x1; 3x3 and what leads to it; 5x5 and what leads to it; after pooling.
struct Inception {
  const char* name;
  int one, three_reduced, three, five_reduced, five, pooled;
};

int add_inception(Drawing* draw, int input, const Inception& of) {
  const std::string name = of.name;
  const int one = draw->convolution(name + "_1x1", input, of.one, 1);
  const int three_reduced = draw->convolution(name + "_3x3_reduce", input, of.three_reduced, 1);
  const int three = draw->convolution(name + "_3x3", three_reduced, of.three, 3, 1, 1);
  const int five_reduced = draw->convolution(name + "_5x5_reduce", input, of.five_reduced, 1);
  const int five = draw->convolution(name + "_5x5", five_reduced, of.five, 5, 1, 2);
  const int pooled = draw->convolution(name + "_pool_proj", draw->max_pool(name + "_pool", input, 3, 1, 1), of.pooled, 1);
  return draw->concat(name, {one, three, five, pooled});
}

void helping_head(Drawing* draw, const std::string& name, int input) {
  const int reduced = draw->convolution(name + "_reduce", draw->average_pool(name + "_pool", input, 5, 3), 128, 1);
  draw->head(name, reduced, 1024, 0.7);
}

NetworkPlan googlenet() {
  NetworkPlan plan{.name = "googlenet", .input = {3, 224, 224}, .mean = kMeanGray, .scale = 1 / kGrayDeviation};
  Drawing draw(&plan);
  int at = draw.convolution("conv1", kImage, 64, 7, 2, 3);
  at = draw.response_norm("norm1", draw.max_pool("pool1", at, 3, 2));
  at = draw.convolution("conv2", draw.convolution("conv2_reduce", at, 64, 1), 192, 3, 1, 1);
  at = draw.max_pool("pool2", draw.response_norm("norm2", at), 3, 2);
  at = add_inception(&draw, at, {"inception_3a", 64, 96, 128, 16, 32, 32});
  at = add_inception(&draw, at, {"inception_3b", 128, 128, 192, 32, 96, 64});
  at = add_inception(&draw, draw.max_pool("pool3", at, 3, 2), {"inception_4a", 192, 96, 208, 16, 48, 64});
  const int first_help = at;
  at = add_inception(&draw, at, {"inception_4b", 160, 112, 224, 24, 64, 64});
  at = add_inception(&draw, at, {"inception_4c", 128, 128, 256, 24, 64, 64});
  at = add_inception(&draw, at, {"inception_4d", 112, 144, 288, 32, 64, 64});
  const int second_help = at;
  at = add_inception(&draw, at, {"inception_4e", 256, 160, 320, 32, 128, 128});
  at = add_inception(&draw, draw.max_pool("pool4", at, 3, 2), {"inception_5a", 256, 160, 320, 32, 128, 128});
  at = add_inception(&draw, at, {"inception_5b", 384, 192, 384, 48, 128, 128});
  draw.end_of_trunk();
  helping_head(&draw, "pose1", first_help);
  helping_head(&draw, "pose2", second_help);
  draw.head("pose", draw.add({.kind = LayerKind::kGlobalAveragePool, .name = "pool5", .inputs = {at}}), 2048, 0.5);
  return plan;
}

int add_residual(Drawing* draw, const std::string& name, int input, int outputs) {
  const int first = draw->normed(name + "_conv1", input, outputs, 3, 2, true);
  const int second = draw->normed(name + "_conv2", first, outputs, 3, 1, false);
  const int direct = draw->normed(name + "_direct", input, outputs, 1, 2, false);
  return draw->add({.kind = LayerKind::kAdd, .name = name, .inputs = {second, direct}, .has_relu = true});
}

NetworkPlan resnet() {
  NetworkPlan plan{.name = "resnet", .input = {1, 96, 128}, .mean = kMeanGray, .scale = 1 / kGrayDeviation};
  Drawing draw(&plan);
  int at = draw.normed("stem", kImage, 16, 5, 2, true);
  for (const auto& [name, outputs] : {std::pair{"block1", 32}, {"block2", 64}, {"block3", 128}})
    at = add_residual(&draw, name, at, outputs);
  draw.end_of_trunk();
  head_with_places(&draw, at);
  return plan;
}

int add_fire(Drawing* draw, const std::string& name, int input, int squeezed, int expanded) {
  const int squeeze = draw->convolution(name + "_squeeze", input, squeezed, 1);
  const int one = draw->convolution(name + "_expand1x1", squeeze, expanded, 1);
  const int three = draw->convolution(name + "_expand3x3", squeeze, expanded, 3, 1, 1);
  return draw->concat(name, {one, three});
}

NetworkPlan squeezenet() {
  NetworkPlan plan{.name = "squeezenet", .input = {3, 168, 224}, .mean = kMeanGray, .scale = 1};  // as its published weights have it
  Drawing draw(&plan);
  int at = draw.max_pool("pool1", draw.convolution("conv1", kImage, 64, 3, 2), 3, 2);
  at = add_fire(&draw, "fire3", add_fire(&draw, "fire2", at, 16, 64), 16, 64);
  at = draw.max_pool("pool3", at, 3, 2);
  at = add_fire(&draw, "fire5", add_fire(&draw, "fire4", at, 32, 128), 32, 128);
  at = draw.max_pool("pool5", at, 3, 2);
  at = add_fire(&draw, "fire7", add_fire(&draw, "fire6", at, 48, 192), 48, 192);
  at = add_fire(&draw, "fire9", add_fire(&draw, "fire8", at, 64, 256), 64, 256);
  draw.end_of_trunk();
  head_with_places(&draw, at);
  return plan;
}

int pooled(const Layer& layer, int size) {
  const int room = size + 2 * layer.padding - layer.kernel;
  return 1 + (layer.kind == LayerKind::kMaxPool ? (room + layer.stride - 1) / layer.stride : room / layer.stride);
}

LayerShape shape_of(const Layer& layer, const LayerShape& input) {
  switch (layer.kind) {
    case LayerKind::kConvolution: return {layer.outputs, pooled(layer, input.height), pooled(layer, input.width)};
    case LayerKind::kMaxPool:
    case LayerKind::kAveragePool: return {input.channels, pooled(layer, input.height), pooled(layer, input.width)};
    case LayerKind::kGlobalAveragePool: return {input.channels, 1, 1};
    case LayerKind::kFullyConnected: return {layer.outputs, 1, 1};
    default: return input;
  }
}

}  // namespace

std::vector<LayerShape> NetworkPlan::shapes() const {
  std::vector<LayerShape> shapes;
  const auto output_of = [&](int index) { return index == kImage ? input : shapes[static_cast<std::size_t>(index)]; };
  for (const Layer& layer : layers) {
    LayerShape shape = shape_of(layer, output_of(layer.inputs.front()));
    if (layer.kind == LayerKind::kConcat) {
      shape.channels = 0;
      for (const int index : layer.inputs) shape.channels += output_of(index).channels;
    }
    shapes.push_back(shape);
  }
  return shapes;
}

Result<NetworkPlan> plan_network(const NetworkChoice& choice) {
  constexpr std::pair<const char*, NetworkPlan (*)()> kNetworks[] = {
      {"googlenet", googlenet}, {"resnet", resnet}, {"squeezenet", squeezenet}};
  for (const auto& [name, make] : kNetworks) {
    if (choice.net != name) continue;
    NetworkPlan plan = make();
    if (choice.has_depth) ++plan.input.channels;
    return plan;
  }
  return {ErrorCode::kInvalid, "there is no network '" + choice.net + "'; known: googlenet, resnet, squeezenet"};
}

}  // namespace camloc::training
