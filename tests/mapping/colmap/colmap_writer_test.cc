// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is written in COLMAP's text format is what is read, to the bit.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/map/synthetic_map.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

using testing::TemporaryFolder;

ColmapModel two_images() {
  ColmapModel model;
  model.cameras = {{1, "PINHOLE", 640, 480, {500, 501, 320, 240}}, {2, "SIMPLE_RADIAL", 640, 480, {500.1, 320, 240, 0.01}}};
  model.points = {{1, {1, 2.0 / 3, 1e-7}, {10, 20, 30}}, {2, {-1e6, 0.5, 4}, {255, 0, 1}}};
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  model.images = {{1, 1, {turned, {0.5, -0.25, 2}}, "dir/a b.png", {{10.5, 20.5, 1}, {600, 400, 0}}}, {2, 2, {}, "c.png", {}}};
  return model;
}

TEST(ColmapWriter, WrittenModelReadsBack) {
  const TemporaryFolder folder;
  const ColmapModel model = two_images();
  const std::string copy = folder.file("copy");
  ASSERT_TRUE(write_colmap_model(model, copy, "made by a test").is_ok());
  const auto again = read_colmap_model(copy);
  ASSERT_TRUE(again.is_ok()) << again.status().message();
  ASSERT_EQ(again->images.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again->images[i].name, model.images[i].name);
    EXPECT_EQ(again->images[i].camera_id, model.images[i].camera_id);
    EXPECT_EQ(again->images[i].T_camera_world.translation, model.images[i].T_camera_world.translation);
    EXPECT_LT(rotation_distance_rad(again->images[i].T_camera_world.rotation, model.images[i].T_camera_world.rotation), 1e-15);
    ASSERT_EQ(again->images[i].observations.size(), model.images[i].observations.size());
    EXPECT_EQ(again->points[i].position, model.points[i].position);
    EXPECT_EQ(again->points[i].rgb, model.points[i].rgb);
    EXPECT_EQ(again->cameras[i].model, model.cameras[i].model);
    EXPECT_EQ(again->cameras[i].parameters, model.cameras[i].parameters);
  }
  EXPECT_EQ(again->images[0].observations[0].point, 1U);
  EXPECT_EQ(again->images[0].observations[1].u, 600);
}

TEST(ColmapWriter, ATextModelIsNotHiddenBesideABinaryOne) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("images.bin"), std::as_bytes(std::span("x", 1)));
  EXPECT_EQ(write_colmap_model({}, folder.path().string(), "").code(), ErrorCode::kInvalid);
  EXPECT_EQ(write_colmap_model({}, folder.file("no/folder"), "").code(), ErrorCode::kIo);
}

TEST(ColmapWriter, LensModelsHaveTheirColmapNames) {
  Intrinsics lens{640, 480, 500, 501, 320, 240, LensModel::kBrownConrady, {0.1, -0.2, 0.001, 0.002, 0}};
  EXPECT_EQ(to_colmap(lens, 1).model, "OPENCV");
  EXPECT_EQ(to_colmap(lens, 1).parameters.size(), 8U);
  lens.distortion[4] = 0.05;
  const ColmapCamera full = to_colmap(lens, 1);
  EXPECT_EQ(full.model, "FULL_OPENCV");
  EXPECT_EQ(full.parameters, (std::vector<double>{500, 501, 320.5, 240.5, 0.1, -0.2, 0.001, 0.002, 0.05, 0, 0, 0}));
  lens.lens = LensModel::kEquidistant;
  EXPECT_EQ(to_colmap(lens, 1).model, "OPENCV_FISHEYE");
  EXPECT_EQ(to_colmap(lens, 1).parameters.size(), 8U);
}

}  // namespace
}  // namespace camloc::mapping
