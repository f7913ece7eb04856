// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording with depth and a COLMAP model of its images in another scale and frame: the poses come out in metres.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/io/image_writer.h"
#include "tests/map/room_map.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

using testing::looking;
using testing::Random;

constexpr double kWall = 3.0;           // the plane x = 3 of the world is all that is seen
constexpr double kUnitsPerMetre = 4.0;  // of the model
constexpr int kNumFrames = 6;

class ColmapPosesTest : public ::testing::Test {
 protected:
  ColmapPosesTest() : camera_(testing::room_camera()) {
    camera_.color = {64, 48, 52, 52, 31.5, 23.5, LensModel::kPinhole, {}};
    camera_.depth = camera_.color;
    for (int i = 0; i < kNumFrames; ++i) poses_.push_back(looking({0.1 * i, 0.2 * i - 0.5, 1.5}, {1, 0.05 * i - 0.1, -0.1}));
    write_recording();
    model_ = make_model();
  }
  /// Distance along the optical axis to the wall at a pixel.
  double depth_at(const Rigid3& T_world_camera, const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray = T_world_camera.rotation * camera_.color.undistort(pixel).homogeneous();
    return (kWall - T_world_camera.translation.x()) / ray.x();
  }
  void write_recording() {
    std::string rgb, depth;
    for (int i = 0; i < kNumFrames; ++i) {
      const std::string stamp = std::to_string(i + 1) + ".000000", color_name = "rgb/" + stamp + ".png",
                        depth_name = "depth/" + stamp + ".png";
      std::filesystem::create_directories(folder_.path() / "rgb");
      std::filesystem::create_directories(folder_.path() / "depth");
      Image<std::uint8_t> gray;
      gray.resize(64, 48);
      ASSERT_TRUE(write_png(folder_.file(color_name), gray).is_ok());
      Image<std::uint16_t> image;
      image.resize(64, 48);
      for (int v = 0; v < 48; ++v) {
        for (int u = 0; u < 64; ++u)
          image.at(u, v) = static_cast<std::uint16_t>(std::lround(1000 * depth_at(poses_[static_cast<std::size_t>(i)], {u, v})));
      }
      ASSERT_TRUE(write_depth_png(folder_.file(depth_name), image).is_ok());
      rgb += stamp + " " + color_name + "\n";
      depth += stamp + " " + depth_name + "\n";
    }
    testing::write_bytes(folder_.file("rgb.txt"), std::as_bytes(std::span(rgb)));
    testing::write_bytes(folder_.file("depth.txt"), std::as_bytes(std::span(depth)));
  }
  /// Its frame is that of the world, turned and shifted, and scaled.
  ColmapModel make_model() {
    const Rigid3 T_model_world{Eigen::Quaterniond(1, 0.2, -0.3, 0.4).normalized(), {5, -7, 1}};
    ColmapModel model;
    model.cameras.push_back(to_colmap(camera_.color, 1));
    Random random(5);
    for (std::uint32_t i = 0; i < kNumFrames; i += i == 0 ? 2 : 1) {  // frame 1 is not in the model
      Rigid3 T_model_camera = T_model_world * poses_[i];
      T_model_camera.translation *= kUnitsPerMetre;
      ColmapImage image{i + 1, 1, T_model_camera.inverse(), "some/folder/" + std::to_string(i + 1) + ".000000.png", {}};
      for (int n = 0; n < 30; ++n) {
        const Eigen::Vector2d pixel(random.uniform(2, 61), random.uniform(2, 45));
        const double z = depth_at(poses_[i], pixel);
        const Eigen::Vector3d p_world = poses_[i] * (z * camera_.color.undistort(pixel).homogeneous());
        image.observations.push_back(
            {pixel.x() + kColmapPixelShift, pixel.y() + kColmapPixelShift, static_cast<std::uint32_t>(model.points.size())});
        model.points.push_back({model.points.size() + 1, kUnitsPerMetre * (T_model_world * p_world), {}});
      }
      model.images.push_back(std::move(image));
    }
    return model;
  }
  Result<PosedFrames> find(PoseCamera pose_camera = PoseCamera::kAuto) {
    EXPECT_TRUE(write_colmap_model(model_, folder_.file("model"), "test").is_ok());
    return find_posed_frames({.sequence = folder_.path().string(), .poses = "colmap:" + folder_.file("model"), .pose_camera = pose_camera},
                             camera_);
  }
  void expect_error(const std::string& part) {
    const auto frames = find();
    ASSERT_FALSE(frames.is_ok());
    EXPECT_EQ(frames.status().code(), ErrorCode::kInvalid);
    EXPECT_NE(frames.status().message().find(part), std::string::npos) << frames.status().message();
  }

  testing::TemporaryFolder folder_;
  RgbdCamera camera_;
  std::vector<Rigid3> poses_;
  ColmapModel model_;
};

TEST_F(ColmapPosesTest, PosesComeOutInMetres) {
  const auto frames = find();
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  ASSERT_TRUE(frames->scale.has_value());
  EXPECT_NEAR(frames->scale->metres_per_unit * kUnitsPerMetre, 1, 2e-3);
  EXPECT_EQ(frames->num_without_pose, 1U);
  ASSERT_EQ(frames->T_map_camera_of_frame.size(), 5U);
  const Rigid3& first = frames->T_map_camera_of_frame.at(0);
  for (const auto& [index, T_map_camera] : frames->T_map_camera_of_frame) {
    const Rigid3 moved = first.inverse() * T_map_camera, expected = poses_[0].inverse() * poses_[index];
    EXPECT_LT((moved.translation - expected.translation).norm(), 3e-3);
    EXPECT_LT(rotation_distance_rad(moved.rotation, expected.rotation), 1e-6);
  }
}

TEST_F(ColmapPosesTest, AnImageThatTheRecordingDoesNotHaveIsLeftOutAndNamed) {
  const auto whole = find();
  ASSERT_TRUE(whole.is_ok()) << whole.status().message();
  model_.images[2].name = "other.png";
  const auto frames = find();
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_EQ(frames->T_map_camera_of_frame.size() + 1, whole->T_map_camera_of_frame.size());
  const bool is_named = std::any_of(frames->notes.begin(), frames->notes.end(),
                                    [](const std::string& note) { return note.find("other.png") != std::string::npos; });
  EXPECT_TRUE(is_named);
}

TEST_F(ColmapPosesTest, TwoImagesOfOneFrameAreNamed) {
  model_.images[2].name = "elsewhere/1.000000.png";
  expect_error("same frame");
}

TEST_F(ColmapPosesTest, ImagesOfAnotherSizeAreRefused) {
  model_.cameras[0].width = 32;
  expect_error("32x48");
}

TEST_F(ColmapPosesTest, PointsThatDoNotFitTheDepthAreRefused) {
  Random random(1);
  for (ColmapPoint& point : model_.points) point.position *= random.uniform(0.2, 3);
  expect_error("scatters");
}

TEST_F(ColmapPosesTest, AModelWithoutPointsHasNoScale) {
  for (ColmapImage& image : model_.images) image.observations.clear();
  model_.points.clear();
  expect_error("0 points with measured depth");
}

TEST_F(ColmapPosesTest, KeypointsOutsideTheImageAndPointsBehindTheCameraSayNothing) {
  for (ColmapImage& image : model_.images) {
    image.observations[0].u = 1e9;
    image.observations[1].v = -1e9;
    image.observations[2].point = image.observations[3].point;
  }
  model_.points[5].position = Eigen::Vector3d::Zero();
  const auto frames = find();
  ASSERT_TRUE(frames.is_ok()) << frames.status().message();
  EXPECT_NEAR(frames->scale->metres_per_unit * kUnitsPerMetre, 1, 5e-3);
}

TEST_F(ColmapPosesTest, PosesAreOfTheColorCamera) {
  EXPECT_FALSE(find(PoseCamera::kDepth).is_ok());
  EXPECT_TRUE(find(PoseCamera::kColor).is_ok());
}

}  // namespace
}  // namespace camloc::mapping
