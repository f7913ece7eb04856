// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc map info` on a map with and without a place in the world.
#include <nlohmann/json.hpp>

#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

std::string write_site(const TemporaryFolder& folder, bool has_wcs) {
  const std::string path = folder / "site.cmap";
  EXPECT_TRUE(write_map(camloc::testing::make_synthetic_map({.has_wcs = has_wcs}), path).is_ok());
  return path;
}

TEST(MapInfoCommand, SaysWhereTheMapLies) {
  const TemporaryFolder folder;
  const std::string path = write_site(folder, true);
  const MapData map = camloc::testing::make_synthetic_map({});
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const MapKeyframe& keyframe : map.keyframes) middle += keyframe.T_map_camera.translation / static_cast<double>(map.keyframes.size());
  const CommandOutput output = run_command(add_map_command, {"map", "info", path, "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const auto datum = nlohmann::json::parse(output.out)["T_wcs_map"];
  const Eigen::Vector3d expected = map.wcs->T_wcs_map * middle;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(datum["middle_m"][axis].get<double>(), expected[axis], 1e-5);
  EXPECT_NEAR(datum["position_m"][0].get<double>(), 1000.5, 1e-9);
  EXPECT_GT(datum["sigma_m"].get<double>(), 0.1);
  EXPECT_NEAR(datum["sigma_deg"].get<double>(), std::sqrt(4e-4 / 3) * 57.29578, 1e-3);
  EXPECT_NE(run_command(add_map_command, {"map", "info", path}).out.find("the middle of the map is at "), std::string::npos);
}

TEST(MapInfoCommand, ListsTheSections) {
  const TemporaryFolder folder, plain_folder;
  const std::string plain = write_site(plain_folder, true);
  MapData map = camloc::testing::make_synthetic_map({});
  map.extra_sections[map_format::section_id("LATR")] = {true, 4, std::vector<std::byte>(20)};
  const std::string path = folder / "site.cmap";
  ASSERT_TRUE(write_map(map, path).is_ok());
  const auto info = nlohmann::json::parse(run_command(add_map_command, {"map", "info", path, "--json"}).out);
  EXPECT_EQ(info["version"], 2);
  ASSERT_EQ(info["sections"].size(), 12U);
  EXPECT_EQ(info["sections"][2],
            nlohmann::json::parse(R"({"name": "landmarks", "known": true, "optional": false, "elements": 40, "bytes": 640})"));
  EXPECT_EQ(info["sections"][11],
            nlohmann::json::parse(R"({"name": "LATR", "known": false, "optional": true, "elements": 5, "bytes": 20})"));
  for (const char* command : {"info", "verify"}) {
    const CommandOutput output = run_command(add_map_command, {"map", command, path});
    EXPECT_EQ(output.exit_code, 0);
    EXPECT_NE(output.out.find("section LATR, 20 bytes"), std::string::npos) << output.out;
    EXPECT_EQ(run_command(add_map_command, {"map", command, plain}).out.find("skipped"), std::string::npos);
  }
}

TEST(MapInfoCommand, SaysHowToPlaceAMap) {
  const TemporaryFolder folder;
  const std::string path = write_site(folder, false);
  EXPECT_NE(run_command(add_map_command, {"map", "info", path}).out.find("camloc map georef"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(run_command(add_map_command, {"map", "info", path, "--json"}).out)["T_wcs_map"].is_null());
}

}  // namespace
}  // namespace camloc::tools
