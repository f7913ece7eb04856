// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc-map georef` as a command: files in, datum in the map, table and JSON out; pixels of recorded frames are localized.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/map/map_unpack.h"
#include "tests/localize/sample_world.h"
#include "tests/mapping/sample_recording.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc-map/commands.h"

namespace camloc::mapping {
namespace {

using camloc::testing::make_synthetic_map;
using camloc::testing::read_bytes;
using camloc::testing::SampleWorld;
using tools::CommandOutput;
using tools::run_command;
using tools::TemporaryFolder;

const Rigid3& T_wcs_map() {
  static const Rigid3 T{exp_so3({0.0, 0.0, 0.5}), {456789.123, 5432109.876, 345.6}};
  return T;
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", value);
  return text;
}

std::string line(const std::string& name, const Eigen::Vector3d& p) {
  return name + "," + number(p.x()) + "," + number(p.y()) + "," + number(p.z()) + "\n";
}

/// A synthetic map, six points picked in it, and their site coordinates.
struct Site {
  explicit Site(int wrong_point = -1) {
    MapData data = make_synthetic_map({.num_landmarks = 200, .side_m = 12, .has_wcs = false});
    map_path = folder / "site.cmap";
    EXPECT_TRUE(write_map(data, map_path).is_ok());
    bytes = read_bytes(map_path);
    std::string points = "name,x,y,z\n", observed;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d p_map(5 * std::cos(2.4 * i), 4 * std::sin(2.4 * i), 0.4 * (i * 5 % 6));
      Eigen::Vector3d p_wcs = T_wcs_map() * p_map;
      if (i == wrong_point) p_wcs.y() += 1;
      points += line("P" + std::to_string(i), p_wcs);
      observed += "P" + std::to_string(i) + ",map," + number(p_map.x()) + "," + number(p_map.y()) + "," + number(p_map.z()) + "\n";
    }
    points_path = folder.write("points.csv", points);
    observed_path = folder.write("observed.csv", observed);
  }

  [[nodiscard]] CommandOutput georef(std::vector<std::string> further = {}) const {
    std::vector<std::string> arguments = {"georef", map_path, "--points", points_path, "--observed", observed_path};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_command(add_georef_command, arguments);
  }
  [[nodiscard]] bool is_map_unchanged() const { return read_bytes(map_path) == bytes; }

  TemporaryFolder folder;
  std::string map_path, points_path, observed_path;
  std::vector<std::byte> bytes;
};

TEST(GeorefCommand, WritesTheDatumAndNothingElse) {
  const Site site;
  const CommandOutput output = site.georef();
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("P3"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("written       " + site.map_path), std::string::npos) << output.out;
  const auto map = MapView::open(site.map_path);
  ASSERT_TRUE(map.is_ok());
  ASSERT_TRUE(map->info().wcs.has_value());
  EXPECT_LT((map->info().wcs->T_wcs_map.translation - T_wcs_map().translation).norm(), 1e-3);
  EXPECT_GT(map->info().wcs->covariance(0, 0), 1e-6);
  MapData data = unpack_map(*map);
  data.wcs.reset();
  EXPECT_TRUE(*serialize_map(data) == site.bytes);
}

TEST(GeorefCommand, OutLeavesTheMapAsItIs) {
  const Site site;
  const std::string out_path = site.folder / "with_datum.cmap";
  ASSERT_EQ(site.georef({"--out", out_path}).exit_code, 0);
  EXPECT_TRUE(site.is_map_unchanged());
  EXPECT_TRUE(MapView::open(out_path)->info().wcs.has_value());
}

TEST(GeorefCommand, DryRunWritesNothing) {
  const Site site;
  const CommandOutput output = site.georef({"--dry-run"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("T_wcs_map"), std::string::npos);
  EXPECT_EQ(output.out.find("written  "), std::string::npos) << output.out;
  EXPECT_TRUE(site.is_map_unchanged());
}

TEST(GeorefCommand, RefusesASuspectAndNamesIt) {
  const Site site(2);
  const CommandOutput output = site.georef();
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("P2 is 1.00 m from where the others put it (dy +1.00 m)"), std::string::npos) << output.err;
  EXPECT_NE(output.out.find("SUSPECT"), std::string::npos) << output.out;
  EXPECT_TRUE(site.is_map_unchanged());
  EXPECT_EQ(site.georef({"--exclude-suspects"}).exit_code, 0);
  EXPECT_FALSE(site.is_map_unchanged());
}

TEST(GeorefCommand, JsonHasWhatTheTableHas) {
  const Site site(2);
  const CommandOutput output = site.georef({"--json"});
  EXPECT_EQ(output.exit_code, 1);
  const auto json = nlohmann::json::parse(output.out);
  ASSERT_EQ(json["points"].size(), 6U);
  EXPECT_EQ(json["points"][2]["verdict"], "SUSPECT");
  EXPECT_EQ(json["points"][1]["verdict"], "good");
  EXPECT_TRUE(json["written"].is_null());
  EXPECT_NEAR(json["fit"]["T_wcs_map"]["position_m"][0].get<double>(), 456789.123, 1e-3);
  EXPECT_NEAR(json["fit"]["scale"].get<double>(), 1, 1e-3);
}

TEST(GeorefCommand, NamesWhatHasNoPartner) {
  const Site site;
  std::ofstream(site.points_path, std::ios::app) << "Q1,1,2,3\n";
  std::ofstream(site.observed_path, std::ios::app) << "Q2,map,1,2,3\nP1,landmark,100000\n";
  const CommandOutput output = site.georef({"--dry-run"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("not observed  Q1"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("not surveyed  Q2"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("P1, landmark 100000: the map has landmarks 0 to 199"), std::string::npos) << output.out;
}

TEST(GeorefCommand, BadInputIsAUsageError) {
  const Site site;
  const struct {
    std::vector<std::string> arguments;
    int exit_code;
    const char* part;
  } cases[] = {
      {{"georef", site.map_path, "--points", site.points_path}, 2, ""},
      {{"georef", site.map_path, "--points", site.folder / "none", "--observed", site.observed_path}, 1, "none"},
      {{"georef", site.folder / "none.cmap", "--points", site.points_path, "--observed", site.observed_path}, 1, "none.cmap"},
      {{"georef", site.map_path, "--points", site.observed_path, "--observed", site.observed_path}, 2, "observed.csv:1: x 'map'"},
      {{"georef", site.map_path, "--points", site.points_path, "--observed", site.folder.write("p", "P1 pixel 3 1 1\n")}, 2, "--sequence"},
      {{"georef", site.map_path, "--points", site.points_path, "--observed", site.observed_path, "--out", site.folder / "no/where"},
       2,
       "--out"},
      {{"georef", site.map_path, "--points", site.points_path, "--observed", site.folder.write("q", "P1 map 1 1 1\n")},
       1,
       "1 common control point;"},
  };
  for (const auto& one : cases) {
    const CommandOutput output = run_command(add_georef_command, one.arguments);
    EXPECT_EQ(output.exit_code, one.exit_code) << output.err;
    EXPECT_NE(output.err.find(one.part), std::string::npos) << output.err;
    EXPECT_TRUE(site.is_map_unchanged());
  }
}

// ---- pixels of a recording of the sample room

/// What the camera sees at a pixel, in the room.
Eigen::Vector3d point_at(std::uint64_t frame, int u, int v) {
  const SampleWorld& world = SampleWorld::get();
  const double z = world.frame(frame).depth.at(u, v) * world.camera().depth_unit_m;
  const Eigen::Vector2d normalized = world.camera().color.undistort({u, v});
  return sample_pose(frame) * Eigen::Vector3d(z * normalized.x(), z * normalized.y(), z);
}

TEST(GeorefCommand, PixelsOfARecordingBecomePointsOfTheMap) {
  const SampleRecording recording(60);
  const TemporaryFolder folder;
  std::string points, observed;
  const struct {
    std::uint64_t frame;
    int u, v;
  } pixels[] = {{10, 80, 60}, {20, 240, 70}, {20, 60, 180}, {31, 160, 120}, {43, 250, 190}, {55, 100, 100}};
  int index = 0;
  for (const auto& pixel : pixels) {
    const std::string name = "P" + std::to_string(index++);
    points += line(name, T_wcs_map() * point_at(pixel.frame, pixel.u, pixel.v));
    observed += name + " pixel " + std::to_string(pixel.frame) + " " + std::to_string(pixel.u) + " " + std::to_string(pixel.v) + "\n";
  }
  observed += "P0 pixel 1000 10 10\nP1 pixel 20 319 239000\n";
  const std::string map_path = SampleWorld::get().map().info().path, out_path = folder / "out.cmap";
  std::vector<std::string> arguments = {"georef",     map_path,
                                        "--points",   folder.write("p", points),
                                        "--observed", folder.write("bad", observed),
                                        "--sequence", recording.folder.path(),
                                        "--camera",   recording.camera_path,
                                        "--out",      out_path};
  EXPECT_EQ(run_command(add_georef_command, arguments).exit_code, 2);  // no image is 239000 pixels high
  observed.resize(observed.rfind("P1"));
  arguments[5] = folder.write("o", observed);
  const CommandOutput output = run_command(add_georef_command, arguments);
  ASSERT_EQ(output.exit_code, 0) << output.err << output.out;
  EXPECT_NE(output.out.find("P0, pixel (10.0, 10.0) of frame 1000: the recording has no such frame"), std::string::npos) << output.out;
  const auto map = MapView::open(out_path);
  ASSERT_TRUE(map.is_ok() && map->info().wcs.has_value());
  const Vector6d error = pose_error(T_wcs_map(), map->info().wcs->T_wcs_map);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.01);
}

TEST(GeorefCommand, FramesOfAnotherPlaceAreLeftOut) {
  const SampleRecording recording(60);
  const Site site;  // its map is no room at all
  std::ofstream(site.observed_path, std::ios::app) << "P1,pixel,10,100,100\n";
  const CommandOutput output = site.georef({"--sequence", recording.folder.path(), "--camera", recording.camera_path, "--dry-run"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("P1, pixel (100.0, 100.0) of frame 10: the frame is not localized in the map: "), std::string::npos)
      << output.out;
}

}  // namespace
}  // namespace camloc::mapping
