// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/sample_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "drivers/sources.h"

namespace camloc {
namespace {

using std::chrono::milliseconds;

std::unique_ptr<FrameSource> open(const std::string& url) {
  auto source = open_frame_source(url);
  EXPECT_TRUE(source.is_ok()) << source.status().message();
  return source ? std::move(source).value() : nullptr;
}

TEST(SampleSource, SameImagesOnEveryRun) {
  const auto a = open("sample://?rate_hz=0&frames=2&width=160&height=120");
  const auto b = open("sample://?rate_hz=0&frames=2&width=160&height=120");
  FrameBuffer frame_a, frame_b;
  for (std::uint64_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(a->next(&frame_a, milliseconds(0)).is_ok());
    ASSERT_TRUE(b->next(&frame_b, milliseconds(0)).is_ok());
    EXPECT_EQ(frame_a.sequence, i);
    EXPECT_EQ(frame_a.gray.pixels, frame_b.gray.pixels);
    EXPECT_EQ(frame_a.depth.pixels, frame_b.depth.pixels);
  }
  EXPECT_EQ(a->next(&frame_a, milliseconds(0)).code(), ErrorCode::kEnd);
  EXPECT_EQ(frame_a.stamp_ns, std::llround(1e9 / 30));
}

TEST(SampleSource, InfoKnowsCameraAndSize) {
  const auto source = open("sample://?width=320&height=200&frames=7");
  EXPECT_EQ(source->info().color_width, 320);
  EXPECT_EQ(source->info().depth_height, 200);
  EXPECT_EQ(source->info().num_frames, 7U);
  ASSERT_TRUE(source->info().camera);
  EXPECT_TRUE(source->info().camera->validate().is_ok());
  EXPECT_FALSE(open("sample://")->info().num_frames);
}

TEST(SampleSource, PathIsSmoothAndClosed) {
  for (std::uint64_t i = 0; i < kSamplePeriod; ++i) {
    const Rigid3 a = sample_pose(i), b = sample_pose(i + 1);
    EXPECT_NEAR(a.rotation.norm(), 1, 1e-12);
    EXPECT_LT((a.translation - b.translation).norm(), 0.05);
    EXPECT_LT(rotation_distance_rad(a.rotation, b.rotation), 0.05);
  }
}

/// The same wall point seen from two poses has the same grey: pose, depth and image agree.
TEST(SampleSource, ImagesDepthAndPosesAgree) {
  const SampleRoom room;
  const RgbdCamera camera = sample_camera(320, 240);
  const Rigid3 T_map_a = sample_pose(10), T_map_b = sample_pose(16);
  FrameBuffer a, b;
  room.render(camera, T_map_a, &a);
  room.render(camera, T_map_b, &b);
  double grey_error = 0;
  int count = 0, depth_matches = 0;
  for (int y = 5; y < 235; y += 3) {
    for (int x = 5; x < 315; x += 3) {
      const double z = a.depth.at(x, y) * camera.depth_unit_m;
      const Eigen::Vector3d p_a((x - camera.color.cx) / camera.color.fx * z, (y - camera.color.cy) / camera.color.fy * z, z);
      const Eigen::Vector3d p_b = T_map_b.inverse() * (T_map_a * p_a);
      const Eigen::Vector2d at = camera.color.project(p_b);
      const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
      if (p_b.z() < 0.1 || u < 0 || v < 0 || u >= 320 || v >= 240) continue;
      ++count;
      depth_matches += std::abs(b.depth.at(u, v) * camera.depth_unit_m - p_b.z()) < 0.05;
      grey_error += std::abs(b.gray.at(u, v) - a.gray.at(x, y));
    }
  }
  ASSERT_GT(count, 4000);
  EXPECT_GT(depth_matches, 0.97 * count);
  EXPECT_LT(grey_error / count, 12.0) << "grey levels 20 to 235; unrelated pixels differ by 70";
}

TEST(SampleSource, EveryViewHasTexture) {
  const SampleRoom room;
  FrameBuffer frame;
  for (std::uint64_t i = 0; i < kSamplePeriod; i += 60) {
    room.render(sample_camera(320, 240), sample_pose(i), &frame);
    int num_edges = 0;
    for (int y = 0; y < 240; ++y) {
      for (int x = 1; x < 320; ++x) num_edges += std::abs(frame.gray.at(x, y) - frame.gray.at(x - 1, y)) > 20;
    }
    EXPECT_GT(num_edges, 1000) << i;
    EXPECT_EQ(std::count(frame.depth.pixels.begin(), frame.depth.pixels.end(), 0), 0);
  }
}

TEST(SampleSource, BadUrls) {
  for (const char* url : {"sample://room", "sample://?width=0", "sample://?frames=-1", "sample://?speed=1", "sample://?height=99999"}) {
    EXPECT_EQ(open_frame_source(url).status().code(), ErrorCode::kInvalid) << url;
  }
}

}  // namespace
}  // namespace camloc
