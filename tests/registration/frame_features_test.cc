// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A frame becomes a view: features, their rays and depths; frames that do not fit the camera are refused.
#include "core/registration/frame_features.h"

#include <gtest/gtest.h>

#include <random>

namespace camloc {
namespace {

RgbdCamera test_camera() {
  RgbdCamera camera;
  camera.name = "test";
  camera.color.width = 320;
  camera.color.height = 240;
  camera.color.fx = camera.color.fy = 262;
  camera.color.cx = 159.5;
  camera.color.cy = 119.5;
  camera.color.lens = LensModel::kBrownConrady;
  camera.color.distortion = {0.1, -0.05, 0.001, 0, 0};
  camera.depth = camera.color;
  return camera;
}

/// Squares of random grey; depth grows from left to right, nothing in the lowest quarter.
FrameBuffer test_frame() {
  std::mt19937 rng(5);
  FrameBuffer frame;
  frame.sequence = 12;
  frame.stamp_ns = 3'456;
  frame.gray.resize(320, 240);
  frame.depth.resize(320, 240);
  std::vector<std::uint8_t> grey(32 * 24);
  for (std::uint8_t& g : grey) g = static_cast<std::uint8_t>(rng() % 256);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      frame.gray.at(x, y) = grey[static_cast<std::size_t>(y / 10 * 32 + x / 10)];
      frame.depth.at(x, y) = static_cast<std::uint16_t>(y >= 180 ? 0 : 1000 + x);
    }
  }
  return frame;
}

TEST(FrameFeatures, RaysAndDepthsBelongToTheirKeypoints) {
  const RgbdCamera camera = test_camera();
  FrameExtractor extractor(camera, OrbOptions{.num_features = 500});
  const FrameBuffer frame = test_frame();
  ASSERT_TRUE(extractor.check(frame.view()).is_ok());
  FrameFeatures view;
  extractor.extract(frame.view(), &view);
  ASSERT_GE(view.size(), 200U);
  EXPECT_LE(view.size(), 500U);
  ASSERT_EQ(view.normalized.size(), view.size());
  ASSERT_EQ(view.depth_m.size(), view.size());
  EXPECT_EQ(view.stamp_ns, 3'456);
  EXPECT_EQ(view.T_map_camera.translation, Eigen::Vector3d::Zero());
  std::size_t num_with_depth = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Keypoint& k = view.features.keypoints[i];
    const Eigen::Vector2d pixel = camera.color.distort(view.normalized[i].cast<double>());
    EXPECT_NEAR(pixel.x(), k.u, 0.05);
    EXPECT_NEAR(pixel.y(), k.v, 0.05);
    EXPECT_TRUE(k.v <= 183 || view.depth_m[i] == 0);
    if (view.depth_m[i] == 0) {
      EXPECT_EQ(view.point_camera(i), Eigen::Vector3d::Zero());
      continue;
    }
    ++num_with_depth;
    EXPECT_NEAR(view.depth_m[i], 1.0 + 0.001 * k.u, 0.004);
    EXPECT_NEAR(view.point_camera(i).z(), view.depth_m[i], 1e-6);
    EXPECT_NEAR(view.point_camera(i).x(), view.depth_m[i] * view.normalized[i].x(), 1e-6);
  }
  EXPECT_GT(num_with_depth, view.size() / 2);
}

TEST(FrameFeatures, TheSameFrameGivesTheSameView) {
  FrameExtractor extractor(test_camera(), OrbOptions{.num_features = 300});
  const FrameBuffer frame = test_frame();
  FrameFeatures a, b;
  extractor.extract(frame.view(), &a);
  extractor.extract(frame.view(), &b);
  EXPECT_EQ(a.features.descriptors, b.features.descriptors);
  EXPECT_EQ(a.normalized, b.normalized);
  EXPECT_EQ(a.depth_m, b.depth_m);
}

TEST(FrameFeatures, FramesThatDoNotFitAreRefusedByName) {
  const FrameExtractor extractor(test_camera(), OrbOptions{});
  const auto expect_refused = [&](const FrameBuffer& frame, const std::string& text) {
    const Status status = extractor.check(frame.view());
    EXPECT_EQ(status.code(), ErrorCode::kInvalid);
    EXPECT_NE(status.message().find("frame 12"), std::string::npos) << status.message();
    EXPECT_NE(status.message().find(text), std::string::npos) << status.message();
  };
  FrameBuffer frame = test_frame();
  frame.gray.resize(64, 48);
  expect_refused(frame, "64x48");
  frame = test_frame();
  frame.depth.resize(160, 120);
  expect_refused(frame, "depth image is 160x120");
  frame = test_frame();
  frame.depth = {};
  expect_refused(frame, "no depth");
  frame = test_frame();
  frame.gray = {};
  expect_refused(frame, "0x0");
}

TEST(FrameFeatures, AnImageOfNothingHasNoFeatures) {
  FrameExtractor extractor(test_camera(), OrbOptions{});
  FrameBuffer frame = test_frame();
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), std::uint8_t{90});
  FrameFeatures view;
  extractor.extract(frame.view(), &view);
  EXPECT_EQ(view.size(), 0U);
  EXPECT_TRUE(view.normalized.empty() && view.depth_m.empty());
}

TEST(FrameFeatures, DepthMayBeAbsentOrUnwanted) {
  const FrameBuffer buffer = test_frame();
  FrameExtractor with(test_camera(), OrbOptions{}), without(test_camera(), OrbOptions{}, false);
  Frame bare = buffer.view();
  bare.depth = {};
  for (const auto& [extractor, frame] : {std::pair{&with, bare}, std::pair{&without, buffer.view()}}) {
    FrameFeatures view;
    extractor->extract(frame, &view);
    EXPECT_GT(view.size(), 100U);
    for (const float z : view.depth_m) ASSERT_EQ(z, 0);
    EXPECT_EQ(extractor->depth_of(frame).at(160, 120), 0);
  }
  EXPECT_NEAR(with.depth_of(buffer.view()).at(160, 120), 1.16, 0.01);
}

TEST(FrameFeatures, AnImageOfTheRightSizeIsAsked) {
  const FrameBuffer buffer = test_frame();
  const FrameExtractor extractor(test_camera(), OrbOptions{});
  EXPECT_TRUE(extractor.has_image(buffer.view()));
  for (int fault = 0; fault < 4; ++fault) {
    Frame frame = buffer.view();
    if (fault == 0) frame.gray = {};
    if (fault == 1) frame.gray.width = 160;
    if (fault == 2) frame.gray.height = 1;
    if (fault == 3) frame.gray.data = nullptr;
    EXPECT_FALSE(extractor.has_image(frame)) << fault;
  }
}

TEST(FrameFeatures, AViewThatIsUsedAgainKeepsNothingOfTheLast) {
  FrameExtractor extractor(test_camera(), OrbOptions{.num_features = 300});
  const FrameBuffer buffer = test_frame();
  FrameBuffer black = buffer;
  std::fill(black.gray.pixels.begin(), black.gray.pixels.end(), std::uint8_t{0});
  FrameFeatures view = extractor.extract_with_patches(buffer.view());
  view.T_map_camera.translation.x() = 3;
  extractor.extract(black.view(), &view);
  EXPECT_EQ(view.size(), 0U);
  EXPECT_TRUE(view.normalized.empty() && view.depth_m.empty() && view.patches.empty());
  EXPECT_EQ(view.T_map_camera.translation, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace camloc
