// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The oracle is OpenCV's dnn module, which is what runs the models.
#include "tools/training/onnx_export.h"

#include <gtest/gtest.h>
#include <torch/utils.h>

#include <opencv2/dnn.hpp>

namespace camloc::training {
namespace {

/// Norms that have seen images.
void fill_norms(PlannedNetwork* network) {
  const torch::NoGradGuard no_gradients;
  for (auto& [index, norm] : (*network)->norms) {
    norm->running_mean.uniform_(-0.5, 0.5);
    norm->running_var.uniform_(0.5, 2);
    norm->weight.uniform_(0.5, 1.5);
    norm->bias.uniform_(-0.3, 0.3);
  }
}

cv::Mat run_by_opencv(const OnnxModel& model, const torch::Tensor& image) {
  const auto bytes = encode_onnx(model);
  EXPECT_TRUE(bytes) << bytes.status().message();
  cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes->data(), bytes->size());
  const std::vector<int> shape(image.sizes().begin(), image.sizes().end());
  net.setInput(cv::Mat(shape, CV_32F, image.data_ptr<float>()));
  return net.forward("pose").clone();
}

class OnnxExport : public ::testing::TestWithParam<const char*> {};

TEST_P(OnnxExport, OpenCvComputesWhatLibtorchDoes) {
  torch::manual_seed(3);
  torch::set_num_threads(1);
  for (const bool has_depth : {false, true}) {
    PlannedNetwork network(*plan_network({GetParam(), has_depth}));
    fill_norms(&network);
    network->eval();
    const torch::NoGradGuard no_gradients;
    const LayerShape& in = network->plan().input;
    const torch::Tensor image = torch::randn({1, in.channels, in.height, in.width});
    const PositionScale scale{{1.5, -2, 0.5}, 0.75};
    const torch::Tensor expected = network->forward(image).back().contiguous();
    const cv::Mat actual = run_by_opencv(to_onnx(network, scale), image);
    ASSERT_EQ(actual.total(), 7U);
    for (int i = 0; i < 7; ++i) {
      const double raw = expected.data_ptr<float>()[i];
      const double wanted = i < 3 ? scale.mean_m[i] + scale.deviation_m * raw : raw;
      EXPECT_NEAR(actual.ptr<float>()[i], wanted, 1e-4 * std::max(1.0, std::abs(wanted))) << GetParam() << " value " << i;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Nets, OnnxExport, ::testing::Values("resnet", "squeezenet", "googlenet"),
                         [](const auto& of) { return std::string(of.param); });

TEST(InitializeTrunk, TakesTheFiltersOfAnotherModelAndNoHead) {
  torch::manual_seed(1);
  PlannedNetwork from(*plan_network({"squeezenet", false})), to(*plan_network({"squeezenet", true}));
  const torch::Tensor head = to->linears.begin()->second->weight.clone();
  ASSERT_TRUE(initialize_trunk(to_onnx(from, {}), &to));
  auto source = from->convolutions.begin();
  for (const auto& [index, convolution] : to->convolutions) {
    if (index >= to->plan().num_trunk_layers) break;
    const auto channels = source->second->weight.size(1);
    EXPECT_TRUE(torch::equal(convolution->weight.slice(1, 0, channels), source->second->weight)) << index;
    if (channels < convolution->weight.size(1)) { EXPECT_EQ(convolution->weight.slice(1, channels).abs().max().item<float>(), 0); }
    ++source;
  }
  EXPECT_TRUE(torch::equal(head, to->linears.begin()->second->weight));
}

TEST(InitializeTrunk, RefusesWhatDoesNotFitAndSaysWhat) {
  PlannedNetwork squeezenet(*plan_network({"squeezenet", false})), googlenet(*plan_network({"googlenet", false})),
      resnet(*plan_network({"resnet", false}));
  const torch::Tensor before = googlenet->convolutions.begin()->second->weight.clone();
  const Status status = initialize_trunk(to_onnx(squeezenet, {}), &googlenet);
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("conv1"), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("64x3x3x3"), std::string::npos) << status.message();
  EXPECT_TRUE(torch::equal(before, googlenet->convolutions.begin()->second->weight));
  EXPECT_FALSE(initialize_trunk(to_onnx(squeezenet, {}), &resnet));
  OnnxModel nothing;
  EXPECT_FALSE(initialize_trunk(nothing, &squeezenet));
}

}  // namespace
}  // namespace camloc::training
