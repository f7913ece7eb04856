// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A textured wall, rendered exactly from known poses, becomes a map.
#include "core/mapmaking/map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/map/map_writer.h"

namespace camloc {
namespace {

constexpr double kWallM = 2.0;  // the wall is the plane z = 2 m of `map`

RgbdCamera wall_camera() {
  RgbdCamera camera;
  camera.name = "test";
  camera.color.width = 320;
  camera.color.height = 240;
  camera.color.fx = camera.color.fy = 262;
  camera.color.cx = 159.5;
  camera.color.cy = 119.5;
  camera.depth = camera.color;
  return camera;
}

MapBuildOptions test_options() {
  MapBuildOptions options;
  options.orb.num_features = 400;
  return options;
}

/// Overlapping rectangles of random grey: many corners, each in surroundings of its own.
class Wall {
 public:
  Wall() : grey_(kSide * kSide, 128) {
    std::mt19937 random(31);
    const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
    for (int i = 0; i < 4000; ++i) {
      const unsigned x0 = below(kSide), y0 = below(kSide), w = 6 + below(30), h = 6 + below(30);
      const auto value = static_cast<std::uint8_t>(below(256));
      for (unsigned y = y0; y < std::min(y0 + h, kSide); ++y) std::fill_n(grey_.begin() + y * kSide + x0, std::min(w, kSide - x0), value);
    }
  }
  [[nodiscard]] double at(double x_m, double y_m) const {
    const double u = std::clamp((x_m + 2.0) / 4.0 * (kSide - 2), 0.0, kSide - 2.001),
                 v = std::clamp((y_m + 2.0) / 4.0 * (kSide - 2), 0.0, kSide - 2.001);
    const auto column = static_cast<unsigned>(u), row = static_cast<unsigned>(v);
    const double fu = u - column, fv = v - row;
    const std::uint8_t* p = grey_.data() + row * kSide + column;
    return (1 - fv) * ((1 - fu) * p[0] + fu * p[1]) + fv * ((1 - fu) * p[kSide] + fu * p[kSide + 1]);
  }

 private:
  static constexpr unsigned kSide = 900;
  std::vector<std::uint8_t> grey_;
};

FrameBuffer render(const Wall& wall, const RgbdCamera& camera, const Rigid3& T_map_camera) {
  FrameBuffer frame;
  frame.gray.resize(camera.color.width, camera.color.height);
  frame.depth.resize(camera.color.width, camera.color.height);
  for (int v = 0; v < camera.color.height; ++v) {
    for (int u = 0; u < camera.color.width; ++u) {
      const Eigen::Vector3d ray((u - camera.color.cx) / camera.color.fx, (v - camera.color.cy) / camera.color.fy, 1);
      const Eigen::Vector3d direction = T_map_camera.rotation * ray;
      const double depth = (kWallM - T_map_camera.translation.z()) / direction.z();
      const Eigen::Vector3d p = T_map_camera.translation + depth * direction;
      frame.gray.at(u, v) = static_cast<std::uint8_t>(std::lround(wall.at(p.x(), p.y())));
      frame.depth.at(u, v) = static_cast<std::uint16_t>(std::lround(depth / camera.depth_unit_m));
    }
  }
  return frame;
}

std::vector<Rigid3> walk() {
  std::vector<Rigid3> poses;
  for (int i = 0; i < 12; ++i)
    poses.push_back({exp_so3({0.01 * (i % 3), 0.02 * (i % 5) - 0.04, 0.01 * i}), {0.09 * i - 0.5, 0.03 * (i % 4), 0.02 * (i % 3)}});
  return poses;
}

Result<MapData> build(const MapBuildOptions& options, MapBuildReport* report) {
  const Wall wall;
  const RgbdCamera camera = wall_camera();
  MapBuilder builder(camera, options);
  for (const Rigid3& T_map_camera : walk()) {
    const FrameBuffer frame = render(wall, camera, T_map_camera);
    EXPECT_TRUE(builder.add_frame(frame.view(), T_map_camera).is_ok());
  }
  return builder.finish(report);
}

TEST(MapBuilder, LandmarksLieOnTheWall) {
  MapBuildReport report;
  const auto map = build(test_options(), &report);
  ASSERT_TRUE(map.is_ok()) << map.status().message();
  EXPECT_EQ(report.num_frames, 12U);
  EXPECT_EQ(report.num_landmarks, map.value().landmarks.size());
  EXPECT_LT(report.num_landmarks, report.num_landmarks_before);
  EXPECT_GE(map.value().landmarks.size(), 300U);
  // Most features of a later view are old acquaintances: far fewer landmarks than features.
  EXPECT_GE(report.num_observations, 2 * report.num_landmarks_before);
  double sum_error_m = 0;
  for (const MapLandmark& landmark : map.value().landmarks) {
    EXPECT_NEAR(landmark.position_m.z(), kWallM, 0.015);
    sum_error_m += std::abs(landmark.position_m.z() - kWallM);
    EXPECT_LT(landmark.direction.z(), -0.7F);
    EXPECT_GE(landmark.num_observations, 1U);
    EXPECT_LE(landmark.min_reference_m, landmark.max_reference_m);
    EXPECT_FALSE(landmark.descriptors.empty());
  }
  EXPECT_LT(sum_error_m / report.num_landmarks, 0.0015);
  // Exact poses.
  EXPECT_LT(map.value().pose_sigma_m, 0.006);
  EXPECT_LT(map.value().pose_sigma_rad, 0.003);
}

TEST(MapBuilder, KeyframesCoverAllLandmarks) {
  MapBuildReport report;
  const auto map = build(test_options(), &report);
  ASSERT_TRUE(map.is_ok());
  EXPECT_LT(report.num_keyframes, report.num_keyframes_before);
  std::vector<int> times(map.value().landmarks.size(), 0);
  for (const MapKeyframe& keyframe : map.value().keyframes) {
    EXPECT_TRUE(std::is_sorted(keyframe.landmarks.begin(), keyframe.landmarks.end()));
    for (const std::uint32_t i : keyframe.landmarks) {
      ASSERT_LT(i, times.size());
      ++times[i];
      // Really in front of that keyframe.
      const Eigen::Vector3d p = keyframe.T_map_camera.inverse() * map.value().landmarks[i].position_m.cast<double>();
      const Eigen::Vector2d pixel = wall_camera().color.project(p);
      EXPECT_GE(pixel.x(), -15);
      EXPECT_LE(pixel.x(), 335);
    }
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 0), 0);
}

TEST(MapBuilder, WordsFindTheirKeyframes) {
  const auto map = build(test_options(), nullptr);
  ASSERT_TRUE(map.is_ok());
  EXPECT_EQ(map.value().inverted_file.size(), map.value().words.size());
  EXPECT_GE(map.value().words.size(), 60U);
  std::size_t entries = 0;
  for (const auto& word : map.value().inverted_file) entries += word.size();
  EXPECT_GE(entries, map.value().keyframes.size() * 10);
}

TEST(MapBuilder, SameFramesGiveTheSameBytes) {
  const auto a = build(test_options(), nullptr), b = build(test_options(), nullptr);
  ASSERT_TRUE(a.is_ok() && b.is_ok());
  EXPECT_EQ(serialize_map(a.value()).value(), serialize_map(b.value()).value());
}

TEST(MapBuilder, ObeysTheByteBudget) {
  MapBuildReport unlimited, limited;
  ASSERT_TRUE(build(test_options(), &unlimited).is_ok());
  MapBuildOptions options = test_options();
  options.max_bytes = unlimited.file_bytes / 2;
  const auto map = build(options, &limited);
  ASSERT_TRUE(map.is_ok()) << map.status().message();
  EXPECT_EQ(limited.file_bytes, serialize_map(map.value()).value().size());
  EXPECT_LE(limited.file_bytes, options.max_bytes);
  EXPECT_GE(limited.file_bytes, options.max_bytes * 7 / 10);

  options.max_bytes = 100;
  const auto impossible = build(options, nullptr);
  ASSERT_FALSE(impossible.is_ok());
  EXPECT_EQ(impossible.status().code(), ErrorCode::kInvalid);
}

TEST(MapBuilder, RefusesFramesThatDoNotFit) {
  const Wall wall;
  const RgbdCamera camera = wall_camera();
  MapBuilder builder(camera, test_options());
  FrameBuffer frame = render(wall, camera, {});
  Rigid3 not_finite;
  not_finite.translation.x() = std::nan("");
  EXPECT_EQ(builder.add_frame(frame.view(), not_finite).code(), ErrorCode::kInvalid);
  Frame without_depth = frame.view();
  without_depth.depth = {};
  EXPECT_EQ(builder.add_frame(without_depth, {}).code(), ErrorCode::kInvalid);
  frame.gray.resize(160, 120);
  const Status status = builder.add_frame(frame.view(), {});
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("160x120"), std::string::npos);
  EXPECT_EQ(builder.progress().num_frames, 0U);
}

TEST(MapBuilder, NothingSeenIsAnError) {
  MapBuilder builder(wall_camera(), test_options());
  EXPECT_EQ(builder.finish(nullptr).status().code(), ErrorCode::kInvalid);
  FrameBuffer blank;
  blank.gray.resize(320, 240);
  blank.depth.resize(320, 240);
  EXPECT_TRUE(builder.add_frame(blank.view(), {}).is_ok());
  EXPECT_EQ(builder.finish(nullptr).status().code(), ErrorCode::kInvalid);
}

}  // namespace
}  // namespace camloc
