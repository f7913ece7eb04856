// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/io/image_writer.h"
#include "tests/base/recording_observer.h"
#include "tests/tools/command_runner.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

RgbdCamera small_camera() {
  RgbdCamera camera;
  camera.color = {160, 120, 130, 130, 79.5, 59.5, LensModel::kPinhole, {}};
  camera.depth = {160, 120, 145, 145, 80, 60, LensModel::kPinhole, {}};
  camera.is_depth_registered = false;
  camera.T_color_depth.translation = {-0.025, 0, 0};
  return camera;
}

/// What the depth camera sees of a wall z = 2 in the world, with a post in front of it.
Image<std::uint16_t> see(const RgbdCamera& camera, const Rigid3& T_world_color) {
  const Rigid3 T_world_depth = T_world_color * camera.T_color_depth;
  Image<std::uint16_t> depth;
  depth.resize(camera.depth.width, camera.depth.height);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const Eigen::Vector2d n = camera.depth.undistort({x, y});
      const Eigen::Vector3d ray = T_world_depth.rotation * Eigen::Vector3d(n.x(), n.y(), 1);
      double z = (2 - T_world_depth.translation.z()) / ray.z();
      const double at_post = (1 - T_world_depth.translation.z()) / ray.z();
      const Eigen::Vector3d p = T_world_depth.translation + at_post * ray;
      if (std::abs(p.x() - 0.2) < 0.1) z = at_post;
      depth.at(x, y) = static_cast<std::uint16_t>(std::lround(1000 * z));
    }
  }
  return depth;
}

TEST(DenseCloud, PutsDepthPixelsWhereTheSurfaceIs) {
  const RgbdCamera camera = small_camera();
  CloudAccumulator accumulator({0.01, 1, 1});
  for (const double angle : {0.0, 0.2, -0.15}) {
    const Rigid3 T_world_color{exp_so3({0.1, angle, 0.05}), {0.3 * angle, 0.1, -0.1}};
    const auto depth = see(camera, T_world_color);
    add_depth_image(camera, depth.view(), T_world_color, &accumulator);
  }
  const PointCloud cloud = accumulator.finish();
  ASSERT_GT(cloud.points_m.size(), 3000U);
  std::size_t num_on_post = 0;
  for (const Eigen::Vector3f& relative : cloud.points_m) {
    const Eigen::Vector3d p = cloud.origin_m + relative.cast<double>();
    const bool is_post = p.z() < 1.5;
    num_on_post += is_post;
    EXPECT_NEAR(p.z(), is_post ? 1 : 2, 0.002);
    EXPECT_LT(is_post ? std::abs(p.x() - 0.2) : 0, 0.1);
  }
  EXPECT_GT(num_on_post, 300U);
}

TEST(DenseCloud, LeavesOutWhatIsFarAndTheEdges) {
  const RgbdCamera camera = small_camera();
  CloudAccumulator accumulator({0.01, 1, 1});
  const Rigid3 T_world_color{Eigen::Quaterniond::Identity(), {0, 0, -2}};  // the post at 3 m, the wall at 4 m
  const auto depth = see(camera, T_world_color);
  add_depth_image(camera, depth.view(), T_world_color, &accumulator);
  const PointCloud cloud = accumulator.finish();
  float low = 1e9F, high = -1e9F;
  for (const Eigen::Vector3f& p : cloud.points_m) {
    low = std::min(low, static_cast<float>(cloud.origin_m.x()) + p.x());
    high = std::max(high, static_cast<float>(cloud.origin_m.x()) + p.x());
  }
  EXPECT_GT(low, 0.1F + 1.5F / 145);  // not the outermost pixels of the post
  EXPECT_LT(high, 0.3F - 1.5F / 145);
  EXPECT_GT(high - low, 0.07F);
}

TEST(DenseCloud, FusesARecordingWhosePosesAreOfTheDepthCamera) {
  RgbdCamera camera = small_camera();
  camera.poses_are_of_depth_camera = true;
  tools::TemporaryFolder folder;
  for (int i = 0; i < 4; ++i) {
    const Rigid3 T_world_depth{exp_so3({0.0, 0.05 * i, 0.0}), {0.1 * i, 0, 0}};
    char name[64];
    std::snprintf(name, sizeof name, "/frame-%06d", i);
    ASSERT_TRUE(write_depth_png(folder.path() + name + ".depth.png", see(camera, T_world_depth * camera.T_color_depth.inverse())).is_ok());
    Image<std::uint8_t> gray;
    gray.resize(160, 120);
    ASSERT_TRUE(write_png(folder.path() + name + ".color.png", gray).is_ok());
    const Eigen::Matrix4d m = T_world_depth.matrix();
    std::string text;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) text += std::to_string(m(row, column)) + (column == 3 ? "\n" : " ");
    ASSERT_FALSE(folder.write(std::string(name + 1) + ".pose.txt", text).empty());
  }
  PosedFramesRequest request;
  request.sequence = folder.path();
  const auto frames = find_posed_frames(request, camera);
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  constexpr double kVoxelM = 0.05;  // three pixels at least
  testing::RecordingObserver observer, stops(1);
  const auto cloud = fuse_dense_cloud(frames.value(), camera, kVoxelM, observer);
  ASSERT_TRUE(cloud.is_ok()) << cloud.status().message();
  EXPECT_EQ(observer.steps.size(), 4U);
  EXPECT_EQ(observer.steps.back().what, "fusing depth images: 4 of 4");
  EXPECT_GT(cloud.value().points_m.size(), 1000U);
  for (const Eigen::Vector3f& relative : cloud.value().points_m) {
    const double z = cloud.value().origin_m.z() + static_cast<double>(relative.z());
    EXPECT_NEAR(z, z < 1.5 ? 1 : 2, 0.002);
  }
  const auto stopped = fuse_dense_cloud(frames.value(), camera, kVoxelM, stops);
  EXPECT_EQ(stopped.status().code(), ErrorCode::kIo);
}

}  // namespace
}  // namespace camloc::mapping
