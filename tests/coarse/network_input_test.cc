// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/network_input.h"

#include <gtest/gtest.h>

#include <cmath>

namespace camloc {
namespace {

RgbdCamera pinhole(int width, int height, double focal, double cx, double cy) {
  RgbdCamera camera;
  camera.color.width = width, camera.color.height = height;
  camera.color.fx = camera.color.fy = focal;
  camera.color.cx = cx, camera.color.cy = cy;
  camera.depth = camera.color;
  return camera;
}

/// A smooth scene on rays: grey 127.5 + 100 sin(4 x) cos(3 y), depth 2 + x / 2 metres.
FrameBuffer scene(const RgbdCamera& camera) {
  FrameBuffer frame;
  frame.gray.resize(camera.color.width, camera.color.height);
  frame.depth.resize(camera.color.width, camera.color.height);
  for (int v = 0; v < camera.color.height; ++v) {
    for (int u = 0; u < camera.color.width; ++u) {
      const Eigen::Vector2d ray = camera.color.undistort({u, v});
      frame.gray.at(u, v) = static_cast<std::uint8_t>(std::lround(127.5 + 100 * std::sin(4 * ray.x()) * std::cos(3 * ray.y())));
      frame.depth.at(u, v) = static_cast<std::uint16_t>(std::lround(2000 + 500 * ray.x()));
    }
  }
  return frame;
}

std::vector<float> filled(const RgbdCamera& camera, const NetworkInputLayout& layout, const FrameBuffer& frame) {
  std::vector<float> out(layout.size(), NAN);
  NetworkInput(camera, layout).fill(frame.view(), out);
  return out;
}

TEST(NetworkInput, ShowsTheSceneWhateverTheCamera) {
  const NetworkInputLayout layout{2, 32, 24, 40, 127.5F, 0.01F};
  std::vector<RgbdCamera> cameras{pinhole(640, 480, 525, 319.5, 239.5), pinhole(320, 240, 250, 170, 110), pinhole(64, 48, 50, 31.5, 23.5)};
  cameras.push_back(cameras[0]);
  cameras.back().color.lens = LensModel::kBrownConrady;
  cameras.back().color.distortion = {0.26, -0.95, -0.005, 0.002, 1.16};
  for (const RgbdCamera& camera : cameras) {
    const std::vector<float> out = filled(camera, layout, scene(camera));
    for (int v = 2; v < 22; ++v) {
      for (int u = 2; u < 30; ++u) {
        const double x = (u - 15.5) / 40, y = (v - 11.5) / 40;
        const auto i = static_cast<std::size_t>(v * 32 + u);
        EXPECT_NEAR(out[i], std::sin(4 * x) * std::cos(3 * y), 0.02) << camera.color.width << " " << u << " " << v;
        EXPECT_NEAR(out[768 + i], (2 + 0.5 * x) / 5, 0.003);
      }
    }
  }
}

TEST(NetworkInput, AveragesByArea) {
  // 4 x 4 camera pixels under one of the network, none cut.
  const RgbdCamera camera = pinhole(32, 32, 32, 15.5, 15.5);
  FrameBuffer frame;
  frame.gray.resize(32, 32);
  for (int v = 0; v < 32; ++v) {
    for (int u = 0; u < 32; ++u) frame.gray.at(u, v) = static_cast<std::uint8_t>((u * 7 + v * 13) % 251);
  }
  const std::vector<float> out = filled(camera, {1, 8, 8, 8, 0, 1}, frame);
  for (int v = 0; v < 8; ++v) {
    for (int u = 0; u < 8; ++u) {
      int sum = 0;
      for (int i = 0; i < 16; ++i) sum += frame.gray.at(4 * u + i % 4, 4 * v + i / 4);
      EXPECT_NEAR(out[static_cast<std::size_t>(8 * v + u)], sum / 16.0, 1e-4);
    }
  }
}

TEST(NetworkInput, OutsideStandsTheEdgeWithoutDepth) {
  const RgbdCamera camera = pinhole(16, 16, 16, 7.5, 7.5);
  FrameBuffer frame;
  frame.gray.resize(16, 16);
  frame.depth.resize(16, 16);
  for (int i = 0; i < 256; ++i) frame.gray.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i % 16 * 10);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{2000});
  // 32 pixels of the network at the camera's focal length: eight beyond each side.
  const std::vector<float> out = filled(camera, {4, 32, 16, 16, 0, 1}, frame);
  EXPECT_FLOAT_EQ(out[0], 0);
  EXPECT_FLOAT_EQ(out[8], 0);
  EXPECT_FLOAT_EQ(out[9], 10);
  EXPECT_FLOAT_EQ(out[31], 150);
  EXPECT_FLOAT_EQ(out[512 + 9], 10);
  EXPECT_FLOAT_EQ(out[1024 + 9], 10);
  EXPECT_FLOAT_EQ(out[1536 + 7], 0);
  EXPECT_FLOAT_EQ(out[1536 + 8], 0.4F);
  EXPECT_FLOAT_EQ(out[1536 + 24], 0);
}

TEST(NetworkInput, DepthIsTheMeanOfWhatIsThere) {
  const RgbdCamera camera = pinhole(16, 16, 16, 7.5, 7.5);
  FrameBuffer frame;
  frame.gray.resize(16, 16);
  frame.depth.resize(16, 16);
  frame.depth.at(0, 0) = 1000;
  frame.depth.at(1, 1) = 3000;
  const std::vector<float> out = filled(camera, {2, 8, 8, 8, 0, 1}, frame);
  EXPECT_FLOAT_EQ(out[64], 0.4F);
  EXPECT_FLOAT_EQ(out[65], 0);
}

TEST(NetworkInput, AFrameOfAnotherSizeIsAllZerosAndOneWithoutDepthHasNone) {
  const RgbdCamera camera = pinhole(16, 16, 16, 7.5, 7.5);
  FrameBuffer frame = scene(pinhole(32, 16, 16, 7.5, 7.5));
  for (const float value : filled(camera, {2, 8, 8, 8, 5, 1}, frame)) EXPECT_EQ(value, 0);
  frame = scene(camera);
  frame.depth.resize(0, 0);
  const std::vector<float> out = filled(camera, {2, 8, 8, 8, 5, 1}, frame);
  EXPECT_NE(out[0], 0);
  for (std::size_t i = 64; i < 128; ++i) EXPECT_EQ(out[i], 0);
}

TEST(NetworkInput, ADepthCameraBesideTheColourCameraIsLookedUp) {
  RgbdCamera camera = pinhole(160, 120, 130, 79.5, 59.5);
  camera.is_depth_registered = false;
  camera.depth.fx = camera.depth.fy = 145;
  camera.T_color_depth.translation = {0.025, 0, 0};
  FrameBuffer frame = scene(camera);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{2500});
  const std::vector<float> out = filled(camera, {2, 16, 12, 16, 0, 1}, frame);
  EXPECT_NEAR(out[192 + 6 * 16 + 8], 0.5F, 1e-3);
}

TEST(NetworkInput, ALensThatFoldsBackShowsTheEdge) {
  RgbdCamera camera = pinhole(64, 48, 40, 31.5, 23.5);
  camera.color.lens = LensModel::kBrownConrady;
  camera.color.distortion = {-0.4, 0, 0, 0, 0};  // its farthest radius is at 0.91
  FrameBuffer frame;
  frame.gray.resize(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) frame.gray.at(u, v) = static_cast<std::uint8_t>(u);
  }
  const std::vector<float> out = filled(camera, {1, 64, 16, 16, 0, 1}, frame);
  for (std::size_t u = 1; u < 64; ++u) EXPECT_GE(out[8 * 64 + u], out[8 * 64 + u - 1] - 1.0F) << u;
}

TEST(NetworkInput, LayoutsAreChecked) {
  EXPECT_TRUE(NetworkInputLayout({1, 128, 96, 100, 0, 1}).validate());
  for (const NetworkInputLayout& bad :
       {NetworkInputLayout{0, 128, 96, 100, 0, 1}, NetworkInputLayout{5, 128, 96, 100, 0, 1}, NetworkInputLayout{1, 7, 96, 100, 0, 1},
        NetworkInputLayout{1, 128, 4096, 100, 0, 1}, NetworkInputLayout{1, 128, 96, 0, 0, 1}, NetworkInputLayout{1, 128, 96, NAN, 0, 1},
        NetworkInputLayout{1, 128, 96, 100, NAN, 1}, NetworkInputLayout{1, 128, 96, 100, 0, 0}}) {
    EXPECT_FALSE(bad.validate());
  }
}

}  // namespace
}  // namespace camloc
