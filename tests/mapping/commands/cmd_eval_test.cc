// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc-map eval` as a command: maps and scans whose relation is known, good and bad.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/sequence.h"
#include "tests/mapping/flat_map.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc-map/commands.h"

namespace camloc::mapping {
namespace {

using tools::CommandOutput;
using tools::run_command;
using tools::TemporaryFolder;

/// A binary PLY of the flat with double coordinates.
std::string scan_of_flat(const Rigid3& T_cloud_flat, double unit_m = 1) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(flat().cloud_m.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (const Eigen::Vector3f& p : flat().cloud_m) {
    const Eigen::Vector3d scanned = (T_cloud_flat * p.cast<double>()) / unit_m;
    bytes.append(reinterpret_cast<const char*>(scanned.data()), 24);
  }
  return bytes;
}

class EvalCommand : public ::testing::Test {
 protected:
  void write(const MapData& map, const std::string& scan) {
    ASSERT_TRUE(write_map(map, folder_ / "m.cmap").is_ok());
    ASSERT_FALSE(folder_.write("scan.ply", scan).empty());
  }
  CommandOutput eval(std::vector<std::string> further = {}) {
    std::vector<std::string> arguments = {"eval", folder_ / "m.cmap", "--lidar", folder_ / "scan.ply"};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return run_command(add_eval_command, arguments);
  }
  nlohmann::json eval_json(std::vector<std::string> further = {}) {
    further.push_back("--json");
    const CommandOutput output = eval(further);
    EXPECT_EQ(output.exit_code, 0) << output.err;
    return nlohmann::json::parse(output.out, nullptr, false);
  }
  std::string control_points(const Rigid3& T_map_flat, const Rigid3& T_cloud_flat, int wrong = -1) {
    std::string text = "# name, map, cloud\n";
    const Eigen::Vector3d corners[] = {{0, 0, 0}, {8, 0, 0}, {8, 5, 0}, {0, 5, 2.6}, {11.2, 4, 2.6}};
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d map = T_map_flat * corners[i], cloud = T_cloud_flat * corners[i] + Eigen::Vector3d(0, 0, i == wrong ? 1 : 0);
      char line[200];
      std::snprintf(line, sizeof line, "P%d %.4f %.4f %.4f %.4f %.4f %.4f\n", i, map.x(), map.y(), map.z(), cloud.x(), cloud.y(),
                    cloud.z());
      text += line;
    }
    return folder_.write("points.txt", text);
  }
  TemporaryFolder folder_;
};

double error_m(const nlohmann::json& json, const Rigid3& T_cloud_map) {
  const auto t = json["alignment"]["T_cloud_map"]["translation_m"].get<std::vector<double>>();
  const auto q = json["alignment"]["T_cloud_map"]["rotation_wxyz"].get<std::vector<double>>();
  const Rigid3 T{Eigen::Quaterniond(q.at(0), q.at(1), q.at(2), q.at(3)), Eigen::Vector3d(t.at(0), t.at(1), t.at(2))};
  return (T_cloud_map.inverse() * T).translation.norm() + 5 * rotation_distance_rad(T.rotation, T_cloud_map.rotation);
}

TEST_F(EvalCommand, MeasuresAMapInItsOwnFrame) {
  write(map_of_flat({}), scan_of_flat({}));
  const nlohmann::json json = eval_json({"--out-dir", folder_ / "report"});
  EXPECT_LT(error_m(json, {}), 0.01);
  EXPECT_EQ(json["alignment"]["search"]["is_map_frame"], true);
  const auto& point = json["distances"]["landmark_to_point"];
  EXPECT_EQ(point["count"].get<std::size_t>(), flat().landmarks_m.size());
  EXPECT_LT(point["mean_m"].get<double>(), 0.025);  // points are 3 cm apart
  EXPECT_LT(json["distances"]["landmark_to_surface"]["median_m"].get<double>(), 0.003);
  EXPECT_GT(point["share_5cm"].get<double>(), 0.99);
  EXPECT_GT(json["coverage"]["share"].get<double>(), 0.9);
  EXPECT_NEAR(json["scale"]["icp"].get<double>(), 1, 0.002);
  EXPECT_NEAR(json["scale"]["volume_ratio"].get<double>(), 1, 0.1);
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
  for (const char* name : {"histogram.png", "top.png", "side.png", "evaluation.json"}) {
    EXPECT_GT(std::filesystem::file_size(folder_ / ("report/" + std::string(name))), 1000U) << name;
  }
}

TEST_F(EvalCommand, GivesTheSameBytesTwice) {
  write(map_of_flat({}), scan_of_flat({}));
  EXPECT_EQ(eval_json({"--align", "none"}), eval_json({"--align", "none"}));
}

TEST_F(EvalCommand, AlignsBySurveyedControlPoints) {
  const Rigid3 T_cloud_flat{exp_so3({0, 0, 2.5}), {3500123.25, 5400456.5, 120.125}}, T_map_flat{exp_so3({1, 2, 0.5}), {4, 5, 6}};
  write(map_of_flat(T_map_flat), scan_of_flat(T_cloud_flat));
  const auto json = eval_json({"--points", control_points(T_map_flat, T_cloud_flat)});
  EXPECT_EQ(json["alignment"]["start"], "control points");
  EXPECT_LT(error_m(json, T_cloud_flat * T_map_flat.inverse()), 0.01);
  EXPECT_LT(json["distances"]["landmark_to_surface"]["mean_m"].get<double>(), 0.006);
  EXPECT_NEAR(json["scale"]["control_points"].get<double>(), 1, 1e-4);
  ASSERT_EQ(json["alignment"]["control_points"].size(), 5U);
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
}

TEST_F(EvalCommand, NamesTheControlPointThatIsWrong) {
  write(map_of_flat({}), scan_of_flat({}));
  const CommandOutput output = eval({"--points", control_points({}, {}, 3)});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_NE(output.out.find("WARNING POINTS: control point P3"), std::string::npos) << output.out;
}

TEST_F(EvalCommand, TakesTheDatumOfTheMap) {
  const Rigid3 T_wcs_map{exp_so3({0.02, 0, 1.5}), {3500123.25, 5400456.5, 120.125}};
  MapData map = map_of_flat({});
  map.wcs = WcsDatum{T_wcs_map, 1e-6 * Matrix6d::Identity()};
  write(map, scan_of_flat(T_wcs_map * Rigid3{exp_so3({0, 0.01, 0}), {0.1, -0.1, 0}}));  // the datum is a little off
  const auto json = eval_json();
  EXPECT_EQ(json["alignment"]["start"], "datum of the map");
  EXPECT_NEAR(json["alignment"]["icp"]["moved_m"].get<double>(), 0.14, 0.05);
  EXPECT_NEAR(json["alignment"]["icp"]["moved_deg"].get<double>(), 0.57, 0.1);
  EXPECT_LT(json["distances"]["landmark_to_surface"]["mean_m"].get<double>(), 0.006);
}

TEST_F(EvalCommand, MeasuresWithoutIcpWhereAsked) {
  write(map_of_flat({Eigen::Quaterniond::Identity(), {0, 0, 0.04}}), scan_of_flat({}));
  const auto json = eval_json({"--align", "none", "--no-icp"});
  EXPECT_LT(error_m(json, {}), 1e-9);
  EXPECT_FALSE(json["alignment"].contains("icp"));
  EXPECT_GT(json["distances"]["landmark_to_point"]["mean_m"].get<double>(), 0.02);
}

TEST_F(EvalCommand, AlignsByTwoTrajectories) {
  const Rigid3 T_cloud_map{exp_so3({2, 1, 0.5}), {40, 5, -6}};
  write(map_of_flat({}), scan_of_flat(T_cloud_map));
  std::string in_map, in_cloud;
  for (int i = 0; i < 6; ++i) {
    in_map += format_tum_line(i * 1000000000LL, camera_in_flat(i)) + "\n";
    in_cloud += format_tum_line(i * 1000000000LL, T_cloud_map * camera_in_flat(i)) + "\n";
  }
  const auto json =
      eval_json({"--trajectory", folder_.write("map.tum", in_map), "--reference-trajectory", folder_.write("cloud.tum", in_cloud)});
  EXPECT_EQ(json["alignment"]["start"], "trajectory");
  EXPECT_LT(error_m(json, T_cloud_map), 0.01);
  EXPECT_NEAR(json["scale"]["camera_positions"].get<double>(), 1, 1e-6);
}

TEST_F(EvalCommand, WarnsAboutAWrongScale) {
  write(map_of_flat({}, 0.97), scan_of_flat({}));
  const auto json = eval_json({"--align", "none"});
  EXPECT_NE(json["warnings"].dump().find("SCALE: by ICP"), std::string::npos) << json["warnings"];
  EXPECT_NEAR(json["scale"]["icp"].get<double>(), 1 / 0.97, 0.005);
}

TEST_F(EvalCommand, WarnsAboutACollapsedMap) {
  write(map_of_flat({}, 0.02), scan_of_flat({}));
  const CommandOutput output = eval({"--align", "none", "--max-distance", "0.2"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("WARNING VOLUME"), std::string::npos) << output.out;
}

TEST_F(EvalCommand, CountsLandmarksOutsideTheScan) {
  MapData map = map_of_flat({});
  for (std::size_t i = 0; i < map.landmarks.size(); i += 3) map.landmarks[i].position_m.x() += 30;
  write(map, scan_of_flat({}));
  const auto json = eval_json({"--align", "none"});
  EXPECT_NEAR(json["distances"]["landmarks_outside"].get<double>(), static_cast<double>(map.landmarks.size()) / 3, 2);
  EXPECT_EQ(json["distances"]["all_landmarks_to_point"]["count"].get<std::size_t>(), map.landmarks.size());
  EXPECT_NE(json["warnings"].dump().find("OVERLAP"), std::string::npos);
}

TEST_F(EvalCommand, OffersAnotherUnit) {
  write(map_of_flat({}), scan_of_flat({}, 0.001));
  const CommandOutput output = eval();
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_NE(output.err.find("--lidar-unit mm"), std::string::npos) << output.err;
  EXPECT_LT(error_m(eval_json({"--lidar-unit", "mm"}), {}), 0.01);
}

TEST_F(EvalCommand, RefusesWhatItCannotUse) {
  write(map_of_flat({}), scan_of_flat({Eigen::Quaterniond::Identity(), {500, 0, 0}}));
  const std::string nothing = folder_.write("empty.xyz", ""), two = folder_.write("two.txt", "A 1 2 3 4 5 6\nB 2 2 3 4 5 6\n");
  const std::string line = folder_.write("line.txt", "A 0 0 0 0 0 0\nB 1 0 0 1 0 0\nC 2 0 0 2 0 0\n"),
                    bad = folder_.write("bad.txt", "A 1 2 3 4 5 six\n");
  const std::string m = folder_ / "m.cmap", scan = folder_ / "scan.ply";
  const struct {
    std::vector<std::string> arguments;
    const char* part;
    int exit_code = 2;
  } cases[] = {
      {{"eval", m}, "--lidar"},
      {{"eval", m, "--lidar", scan, "--reference-sequence", "x"}, "either"},
      {{"eval", m, "--reference-sequence", "x"}, "--camera"},
      {{"eval", m, "--lidar", scan, "--trajectory", "x"}, "--reference-trajectory"},
      {{"eval", m, "--lidar", "/no/such.ply"}, "no such file", 1},
      {{"eval", "/no/such.cmap", "--lidar", scan}, "/no/such.cmap", 1},
      {{"eval", m, "--lidar", nothing}, "empty"},
      {{"eval", m, "--lidar", scan, "--align", "none"}, "do not overlap", 1},
      {{"eval", m, "--lidar", scan, "--align", "datum"}, "no datum"},
      {{"eval", m, "--lidar", scan, "--align", "points"}, "--points"},
      {{"eval", m, "--lidar", scan, "--points", two}, "at least 3"},
      {{"eval", m, "--lidar", scan, "--points", line}, "one line"},
      {{"eval", m, "--lidar", scan, "--points", bad}, "bad.txt:1"},
      {{"eval", m, "--lidar", scan, "--min-observations", "300"}, "--min-observations"},
      {{"eval", m, "--lidar", scan, "--out-dir", m}, "folder"},
  };
  for (const auto& c : cases) {
    const CommandOutput output = run_command(add_eval_command, c.arguments);
    EXPECT_EQ(output.exit_code, c.exit_code) << c.part;
    EXPECT_NE(output.err.find(c.part), std::string::npos) << output.err;
    EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1) << output.err;
    EXPECT_TRUE(output.out.empty());
  }
}

}  // namespace
}  // namespace camloc::mapping
