// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is exported says the same as the map: PLY through a reader of its own, the COLMAP model by projecting its points with
// COLMAP's rules, the trajectory through the reader for recordings.
#include "tools/mapping/colmap/map_export.h"

#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <sstream>

#include "core/io/sequence.h"
#include "tests/map/room_map.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class ExportTest : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    const Status written = write_map(data, folder_.file("m.cmap"));
    EXPECT_TRUE(written.is_ok()) << written.message();
    auto map = MapView::open(folder_.file("m.cmap"));
    EXPECT_TRUE(map.is_ok()) << map.status().message();
    return std::move(map).value();
  }
  testing::TemporaryFolder folder_;
};

/// Rows of a binary little-endian PLY with one element, every property as a double.
struct PlyRows {
  std::vector<std::string> names, types, comments;
  std::vector<std::vector<double>> rows;
};

double read_little_endian(const std::string& bytes, std::size_t at, const std::string& type) {
  std::uint64_t bits = 0;
  const std::size_t size = type == "double" ? 8 : type == "float" ? 4 : 1;
  for (std::size_t i = 0; i < size; ++i) bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes.at(at + i))) << (8 * i);
  if (type == "double") return std::bit_cast<double>(bits);
  if (type == "float") return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  return static_cast<double>(bits);
}

PlyRows read_ply(const std::string& bytes) {
  PlyRows ply;
  std::istringstream header(bytes);
  std::string line, word;
  std::size_t count = 0;
  std::getline(header, line);
  EXPECT_EQ(line, "ply");
  std::getline(header, line);
  EXPECT_EQ(line, "format binary_little_endian 1.0");
  while (std::getline(header, line) && line != "end_header") {
    std::istringstream fields(line);
    fields >> word;
    if (word == "comment") ply.comments.push_back(line.substr(8));
    if (word == "element") fields >> word >> count;
    if (word == "property") {
      ply.types.emplace_back();
      ply.names.emplace_back();
      fields >> ply.types.back() >> ply.names.back();
    }
  }
  auto at = static_cast<std::size_t>(header.tellg());
  for (std::size_t row = 0; row < count; ++row) {
    ply.rows.emplace_back();
    for (const std::string& type : ply.types) {
      ply.rows.back().push_back(read_little_endian(bytes, at, type));
      at += type == "double" ? 8 : type == "float" ? 4 : 1;
    }
  }
  EXPECT_EQ(at, bytes.size());
  return ply;
}

TEST_F(ExportTest, PlyHoldsEveryLandmark) {
  const MapView map = open(make_room_map());
  const PlyRows ply = read_ply(format_ply(map, {}));
  const std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "num_observations", "position_sigma_m"};
  ASSERT_EQ(ply.names, names);
  ASSERT_EQ(ply.rows.size(), 360U);
  EXPECT_EQ(ply.types[0], "float");
  EXPECT_NE(ply.comments[0].find("metres, coordinates of the map"), std::string::npos) << ply.comments[0];
  for (std::uint32_t i = 0; i < 360; ++i) {
    const auto& row = ply.rows[i];
    const Eigen::Vector3f position = map.position_m(i), direction = MapView::direction(map.landmarks()[i]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(row[static_cast<std::size_t>(axis)], static_cast<double>(position[axis]));
      EXPECT_NEAR(row[static_cast<std::size_t>(axis) + 3], direction[axis], 1e-6);
    }
    EXPECT_EQ(row[9], map.landmarks()[i].num_observations);
    EXPECT_NEAR(row[10], 0.01, 1e-6);
  }
}

TEST_F(ExportTest, PlyInSiteCoordinatesKeepsMillimetresFarFromTheOrigin) {
  const MapView map = open(make_room_map({.has_wcs = true}));
  ASSERT_TRUE(check_export(map, {.use_wcs = true}).is_ok());
  const PlyRows ply = read_ply(format_ply(map, {.use_wcs = true}));
  EXPECT_EQ(ply.types[0], "double");
  const Rigid3& T_wcs_map = map.info().wcs->T_wcs_map;
  for (std::uint32_t i = 0; i < ply.rows.size(); ++i) {
    const Eigen::Vector3d expected = T_wcs_map * map.position_m(i).cast<double>();
    const Eigen::Vector3d written(ply.rows[i][0], ply.rows[i][1], ply.rows[i][2]);
    EXPECT_LT((written - expected).norm(), 1e-8);
    EXPECT_GT(written.x(), 3500000);
  }
}

TEST_F(ExportTest, SiteCoordinatesNeedADatum) {
  const MapView map = open(make_room_map());
  const Status status = check_export(map, {.use_wcs = true});
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("georef"), std::string::npos);
}

TEST_F(ExportTest, ColorsFollowHeightOrObservations) {
  const MapView map = open(make_room_map());
  const PlyRows height = read_ply(format_ply(map, {})), seen = read_ply(format_ply(map, {.coloring = PointColoring::kObservations}));
  const auto highest = std::max_element(height.rows.begin(), height.rows.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  const auto lowest = std::min_element(height.rows.begin(), height.rows.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  const auto luma = [](const std::vector<double>& row) { return 0.3 * row[6] + 0.59 * row[7] + 0.11 * row[8]; };
  EXPECT_GT(std::abs(luma(*highest) - luma(*lowest)), 80);  // readable without hue
  const auto most = std::max_element(seen.rows.begin(), seen.rows.end(), [](const auto& a, const auto& b) { return a[9] < b[9]; });
  const auto fewest = std::min_element(seen.rows.begin(), seen.rows.end(), [](const auto& a, const auto& b) { return a[9] < b[9]; });
  EXPECT_GT(std::abs(luma(*most) - luma(*fewest)), 60);
}

TEST_F(ExportTest, ColmapPointsProjectOntoTheirObservations) {
  const MapView map = open(make_room_map());
  const std::string folder = folder_.file("model");
  ASSERT_TRUE(write_colmap_model(make_colmap_model(map, {}), folder, "test").is_ok());
  const auto model = read_colmap_model(folder);
  ASSERT_TRUE(model.is_ok()) << model.status().message();
  ASSERT_EQ(model->cameras.size(), 1U);
  EXPECT_EQ(model->cameras[0].model, "PINHOLE");
  const auto& K = model->cameras[0].parameters;
  EXPECT_EQ(K, (std::vector<double>{520, 521, 320, 240.75}));  // COLMAP's first pixel has its centre at 0.5
  ASSERT_EQ(model->images.size(), 9U);
  ASSERT_EQ(model->points.size(), 360U);
  std::size_t num_seen = 0;
  for (std::uint32_t k = 0; k < 9; ++k) {
    const ColmapImage& image = model->images[k];
    EXPECT_EQ(image.name, "keyframe-00000" + std::to_string(k));
    EXPECT_LT((image.T_camera_world.inverse().translation - map.keyframe_pose(k).translation).norm(), 1e-9);
    for (const ColmapObservation& seen : image.observations) {
      const Eigen::Vector3d p = image.T_camera_world * model->points[seen.point].position;
      EXPECT_NEAR(seen.u, K[0] * p.x() / p.z() + K[2], 0.01);
      EXPECT_NEAR(seen.v, K[1] * p.y() / p.z() + K[3], 0.01);
      EXPECT_TRUE(seen.u >= 0 && seen.u <= 640 && seen.v >= 0 && seen.v <= 480);
    }
    num_seen += image.observations.size();
  }
  std::size_t num_listed = 0;
  for (const auto& keyframe : map.keyframes()) num_listed += keyframe.num_landmark_entries;
  EXPECT_NEAR(static_cast<double>(num_seen), static_cast<double>(num_listed), 4);  // on the image border positions round
}

TEST_F(ExportTest, TrajectoryReadsBackAsKeyframes) {
  const MapView map = open(make_room_map({.has_wcs = true}));
  for (const bool use_wcs : {false, true}) {
    const std::string text = format_tum(map, {.use_wcs = use_wcs});
    testing::write_bytes(folder_.file("t.tum"), std::as_bytes(std::span(text)));
    const auto poses = read_tum_trajectory(folder_.file("t.tum"));
    ASSERT_TRUE(poses.is_ok()) << poses.status().message();
    ASSERT_EQ(poses->size(), 9U);
    const Rigid3 T_out_map = use_wcs ? map.info().wcs->T_wcs_map : Rigid3{};
    for (std::uint32_t k = 0; k < 9; ++k) {
      const Rigid3 expected = T_out_map * map.keyframe_pose(k);
      EXPECT_EQ((*poses)[k].stamp_ns, 1'000'000'000LL * k);
      EXPECT_LT(((*poses)[k].T_world_camera.translation - expected.translation).norm(), 1e-7);
      EXPECT_LT(rotation_distance_rad((*poses)[k].T_world_camera.rotation, expected.rotation), 1e-7);
    }
  }
}

TEST_F(ExportTest, ANameOfTheMapCannotBreakAHeader) {
  MapData data = make_room_map();
  data.name = "a\nend_header\nb";
  const MapView map = open(data);
  EXPECT_EQ(read_ply(format_ply(map, {})).rows.size(), 360U);
}

}  // namespace
}  // namespace camloc::mapping
