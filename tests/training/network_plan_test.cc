// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/network_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace camloc::training {
namespace {

LayerShape shape_of(const NetworkPlan& plan, const std::string& layer) {
  const auto shapes = plan.shapes();
  for (std::size_t i = 0; i < plan.layers.size(); ++i)
    if (plan.layers[i].name == layer) return shapes[i];
  ADD_FAILURE() << "no layer " << layer;
  return {};
}

// Szegedy et al., "Going deeper with convolutions", 2015, table 1.
TEST(NetworkPlan, GoogLeNetHasTheShapesOfItsPaper) {
  const auto plan = plan_network({"googlenet", false});
  ASSERT_TRUE(plan);
  const std::pair<const char*, LayerShape> expected[] = {
      {"conv1", {64, 112, 112}},       {"pool1", {64, 56, 56}},         {"conv2", {192, 56, 56}},        {"pool2", {192, 28, 28}},
      {"inception_3a", {256, 28, 28}}, {"inception_3b", {480, 28, 28}}, {"inception_4a", {512, 14, 14}}, {"inception_4d", {528, 14, 14}},
      {"inception_4e", {832, 14, 14}}, {"inception_5b", {1024, 7, 7}},  {"pool5", {1024, 1, 1}},         {"pose1_reduce", {128, 4, 4}}};
  for (const auto& [layer, shape] : expected) {
    const LayerShape actual = shape_of(*plan, layer);
    EXPECT_EQ(actual.channels, shape.channels) << layer;
    EXPECT_EQ(actual.height, shape.height) << layer;
    EXPECT_EQ(actual.width, shape.width) << layer;
  }
  EXPECT_EQ(plan->heads.size(), 3U);
  const auto num_convolutions = std::count_if(plan->layers.begin(), plan->layers.begin() + plan->num_trunk_layers,
                                              [](const Layer& layer) { return layer.kind == LayerKind::kConvolution; });
  EXPECT_EQ(num_convolutions, 57);
}

TEST(NetworkPlan, EveryHeadIsAPose) {
  for (const char* net : {"googlenet", "resnet", "squeezenet"}) {
    for (const bool has_depth : {false, true}) {
      const auto plan = plan_network({net, has_depth});
      ASSERT_TRUE(plan) << net;
      EXPECT_EQ(plan->input.channels, plan_network({net, false})->input.channels + (has_depth ? 1 : 0)) << net;
      for (const int head : plan->heads) EXPECT_EQ(plan->shapes()[static_cast<std::size_t>(head)].size(), 7) << net;
    }
  }
}

TEST(NetworkPlan, LayersComeAfterTheirInputsAndHaveNamesOfTheirOwn) {
  for (const char* net : {"googlenet", "resnet", "squeezenet"}) {
    const auto plan = plan_network({net, false});
    ASSERT_TRUE(plan);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < plan->layers.size(); ++i) {
      for (const int input : plan->layers[i].inputs) EXPECT_LT(input, static_cast<int>(i)) << net;
      names.push_back(plan->layers[i].name);
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << net;
  }
}

TEST(NetworkPlan, AnUnknownNetworkIsRefusedWithTheKnownOnes) {
  const auto plan = plan_network({"vgg", false});
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(plan.status().message().find("googlenet, resnet, squeezenet"), std::string::npos);
}

}  // namespace
}  // namespace camloc::training
