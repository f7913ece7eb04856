// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/observations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

TEST(FrameObservations, AreTheFeaturesAsMeasurements) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer buffer = world.frame(7);
  FrameObservations observations(world.camera(), OrbOptions{}, true);
  ASSERT_TRUE(observations.observe(buffer.view()));
  ASSERT_GT(observations.size(), 500U);
  const Intrinsics& k = world.camera().color;
  int num_with_depth = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Keypoint& keypoint = observations.features().keypoints[i];
    EXPECT_NEAR(observations.x(i), (keypoint.u - k.cx) / k.fx, 1e-5);
    EXPECT_NEAR(observations.y(i), (keypoint.v - k.cy) / k.fy, 1e-5);
    EXPECT_NEAR(observations.sigma_px(i), std::pow(1.2, keypoint.level), 1e-4);
    EXPECT_EQ(observations.depth_m(i), observations.depth_at(keypoint.u, keypoint.v));
    if (observations.depth_m(i) == 0) continue;
    ++num_with_depth;
    const double raw = buffer.depth.at(static_cast<int>(std::lround(keypoint.u)), static_cast<int>(std::lround(keypoint.v)));
    EXPECT_NEAR(observations.depth_m(i), 0.001 * raw, 0.03 * 0.001 * raw);
  }
  EXPECT_GT(num_with_depth, static_cast<int>(observations.size()) * 9 / 10);
}

TEST(FrameObservations, LensIsUndistorted) {
  const SampleWorld& world = SampleWorld::get();
  RgbdCamera camera = world.camera();
  camera.color.lens = LensModel::kBrownConrady;
  camera.color.distortion = {0.1, -0.05, 0.001, 0.001, 0};
  FrameObservations observations(camera, OrbOptions{}, true);
  const FrameBuffer buffer = world.frame(7);
  ASSERT_TRUE(observations.observe(buffer.view()));
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Keypoint& keypoint = observations.features().keypoints[i];
    const Eigen::Vector2d pixel = camera.color.distort({observations.x(i), observations.y(i)});
    EXPECT_NEAR(pixel.x(), keypoint.u, 0.05);
    EXPECT_NEAR(pixel.y(), keypoint.v, 0.05);
  }
}

TEST(FrameObservations, DepthMayBeAbsentOrUnwanted) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer buffer = world.frame(7);
  FrameObservations with(world.camera(), OrbOptions{}, true), without(world.camera(), OrbOptions{}, false);
  Frame frame = buffer.view();
  ASSERT_TRUE(without.observe(frame));
  frame.depth = {};
  ASSERT_TRUE(with.observe(frame));
  for (const auto* observations : {&with, &without}) {
    for (std::size_t i = 0; i < observations->size(); ++i) ASSERT_EQ(observations->depth_m(i), 0);
    EXPECT_EQ(observations->depth_at(160, 120), 0);
  }
}

TEST(FrameObservations, BadImagesLeaveNothingBehind) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer buffer = world.frame(7);
  FrameObservations observations(world.camera(), OrbOptions{}, true);
  for (int fault = 0; fault < 4; ++fault) {
    ASSERT_TRUE(observations.observe(buffer.view()));
    ASSERT_GT(observations.size(), 0U);
    Frame frame = buffer.view();
    if (fault == 0) frame.gray = {};
    if (fault == 1) frame.gray.width = 160;
    if (fault == 2) frame.gray.height = 1;
    if (fault == 3) frame.gray.data = nullptr;
    EXPECT_FALSE(observations.observe(frame)) << fault;
    EXPECT_EQ(observations.size(), 0U) << fault;
    EXPECT_EQ(observations.depth_at(160, 120), 0) << fault;
  }
}

TEST(FrameObservations, NeverMoreThanTheOptionSays) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer buffer = world.frame(7);
  FrameObservations observations(world.camera(), OrbOptions{.num_features = 100}, true);
  ASSERT_TRUE(observations.observe(buffer.view()));
  EXPECT_LE(observations.size(), 100U);
  EXPECT_GT(observations.size(), 50U);
}

}  // namespace
}  // namespace camloc
