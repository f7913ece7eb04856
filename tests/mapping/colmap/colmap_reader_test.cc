// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// COLMAP text models: what is written is read back, what others wrote is understood, and what is broken is named.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "tests/map/synthetic_map.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

using testing::TemporaryFolder;

constexpr const char* kCameras = "# comment\n1 PINHOLE 640 480 500 501 320 240\n7 SIMPLE_RADIAL 640 480 500 320 240 0.01\n";
constexpr const char* kImages =
    "# comment\n"
    "3 1 0 0 0 0.5 -0.25 2 1 dir/a b.png\n"
    "10.5 20.5 77 30 40 -1 600 400 5\n"
    "9 0.5 0.5 -0.5 0.5 1 2 3 7 c.png\n"
    "\n";
constexpr const char* kPointLines = "# comment\n5 1 2 3 10 20 30 0.5\n77 -1 0.5 4 255 0 1 1.25 3 0 9 2\n";

class ColmapModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write("cameras.txt", kCameras);
    write("images.txt", kImages);
    write("points3D.txt", kPointLines);
  }
  void write(const char* name, const std::string& text) { testing::write_bytes(folder_.file(name), std::as_bytes(std::span(text))); }
  Result<ColmapModel> read() { return read_colmap_model(folder_.path().string()); }
  void expect_error(const char* file, const std::string& text, const std::string& part) {
    SetUp();
    write(file, text);
    const auto model = read();
    ASSERT_FALSE(model.is_ok()) << text;
    EXPECT_EQ(model.status().code(), ErrorCode::kInvalid);
    EXPECT_NE(model.status().message().find(file), std::string::npos) << model.status().message();
    EXPECT_NE(model.status().message().find(part), std::string::npos) << model.status().message();
  }
  TemporaryFolder folder_;
};

TEST_F(ColmapModelTest, ReadsWhatColmapWrites) {
  const auto model = read();
  ASSERT_TRUE(model.is_ok()) << model.status().message();
  ASSERT_EQ(model->cameras.size(), 2U);
  EXPECT_EQ(model->cameras[1].model, "SIMPLE_RADIAL");
  EXPECT_EQ(model->cameras[1].parameters.size(), 4U);
  ASSERT_EQ(model->images.size(), 2U);
  EXPECT_EQ(model->images[0].name, "dir/a b.png");
  EXPECT_EQ(model->images[0].T_camera_world.translation, Eigen::Vector3d(0.5, -0.25, 2));
  ASSERT_EQ(model->images[0].observations.size(), 2U);  // the one without a point is left out
  EXPECT_EQ(model->points[model->images[0].observations[0].point].id, 77U);
  EXPECT_EQ(model->images[0].observations[1].u, 600);
  EXPECT_TRUE(model->images[1].observations.empty());
  const Eigen::Quaterniond& q = model->images[1].T_camera_world.rotation;  // order w x y z
  EXPECT_EQ(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()), Eigen::Vector4d(0.5, 0.5, -0.5, 0.5));
}

TEST_F(ColmapModelTest, WrongLinesAreNamed) {
  expect_error("cameras.txt", "", "holds no camera");
  expect_error("cameras.txt", "1 PINHOLE 640\n", ":1: ");
  expect_error("cameras.txt", "\n1 PINHOLE 640 0 1\n", ":2: ");
  expect_error("cameras.txt", "1 PINHOLE 640 480 x\n", "parameter");
  expect_error("cameras.txt", "1 A 6 4 1\n1 A 6 4 1\n", "second time");
  expect_error("points3D.txt", "5 1 2 3 10 20 30\n", ":1: ");
  expect_error("points3D.txt", "5 1 2 3 10 20 300 0.5\n", ":1: ");
  expect_error("points3D.txt", "5 1 nan 3 10 20 30 0.5\n", ":1: ");
  expect_error("points3D.txt", "5 1 2 3 10 20 30 0.5 3\n", "pairs");
  expect_error("points3D.txt", "5 1 2 3 1 1 1 0\n5 1 2 3 1 1 1 0\n", "second time");
  expect_error("images.txt", "", "holds no image");
  expect_error("images.txt", "3 1 0 0 0 0.5 -0.25 2 1\n\n", ":1: ");
  expect_error("images.txt", "3 2 0 0 0 0.5 -0.25 2 1 a.png\n\n", ":1: ");
  expect_error("images.txt", "3 1 0 0 0 inf -0.25 2 1 a.png\n\n", ":1: ");
  expect_error("images.txt", "3 1 0 0 0 0.5 -0.25 2 4 a.png\n\n", "camera 4");
  expect_error("images.txt", "3 1 0 0 0 0 0 2 1 a.png\n\n3 1 0 0 0 0 0 2 1 b.png\n\n", "second time");
  expect_error("images.txt", "3 1 0 0 0 0 0 2 1 a.png\n1 2\n", "triples");
  expect_error("images.txt", "3 1 0 0 0 0 0 2 1 a.png\n1 2 6\n", "point 6");
}

TEST_F(ColmapModelTest, MissingFilesAreNamed) {
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    SetUp();
    std::filesystem::remove(folder_.file(name));
    const auto model = read();
    EXPECT_EQ(model.status().code(), ErrorCode::kNotFound);
    EXPECT_NE(model.status().message().find(name), std::string::npos) << model.status().message();
  }
  EXPECT_EQ(read_colmap_model(folder_.file("nowhere")).status().code(), ErrorCode::kNotFound);
}

TEST_F(ColmapModelTest, ABinaryModelSaysHowToConvertIt) {
  std::filesystem::remove(folder_.file("images.txt"));
  write("images.bin", "x");
  const auto model = read();
  ASSERT_FALSE(model.is_ok());
  EXPECT_NE(model.status().message().find("model_converter"), std::string::npos) << model.status().message();
  EXPECT_NE(model.status().message().find("--output_type TXT"), std::string::npos);
}

TEST_F(ColmapModelTest, LinesMayEndAsOnOtherSystems) {
  std::string images = kImages;
  for (std::size_t at = 0; (at = images.find('\n', at)) != std::string::npos; at += 2) images.replace(at, 1, "\r\n");
  write("images.txt", images);
  const auto model = read();
  ASSERT_TRUE(model.is_ok()) << model.status().message();
  EXPECT_EQ(model->images[1].name, "c.png");
}

}  // namespace
}  // namespace camloc::mapping
