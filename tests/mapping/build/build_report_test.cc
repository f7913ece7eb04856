// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a build says, with and without what only some builds have.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/mapping/build/map_pipeline.h"

namespace camloc::mapping {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

BuildSummary summary() {
  BuildSummary s;
  s.map_path = "room.cmap";
  s.num_recorded = 100, s.num_selected = 90, s.num_without_pose = 4, s.num_without_depth = 3;
  s.reading.num_corrupt = 2;
  s.build.num_frames = 81;
  s.build.num_landmarks = 50, s.build.num_landmarks_before = 80;
  s.build.num_keyframes = 7, s.build.num_keyframes_before = 20;
  s.build.file_bytes = 5000;
  s.build.num_consistency_pairs = 12;
  s.consistency_sigma_m = 0.02, s.consistency_sigma_rad = 0.01;
  s.seconds = 9;
  return s;
}

TEST(BuildReport, GivenPosesNeedNoSlam) {
  const std::string table = format_table(summary());
  EXPECT_TRUE(contains(table, "81 of 100 recorded, 90 selected")) << table;
  EXPECT_TRUE(contains(table, "4 without pose, 3 without depth, 2 broken")) << table;
  EXPECT_TRUE(contains(table, "landmarks kept        50 of 80")) << table;
  EXPECT_TRUE(contains(table, "7 of 20 views")) << table;
  EXPECT_TRUE(contains(table, "5000 bytes, 100.0 a landmark")) << table;
  EXPECT_TRUE(contains(table, "2.0 cm, 0.57 deg per axis between views (12 pairs)")) << table;
  EXPECT_TRUE(contains(table, "9.0 s, 9 frames/s")) << table;
  EXPECT_FALSE(contains(table, "frames tracked") || contains(table, "interrupted") || contains(table, "deformation"));
  const auto json = nlohmann::json::parse(format_json(summary()), nullptr, false);
  EXPECT_EQ(json["frames"]["used"], 81);
  EXPECT_EQ(json["frames"]["broken"], 2);
  EXPECT_EQ(json["landmarks"]["before"], 80);
  EXPECT_EQ(json["bytes_per_landmark"], 100.0);
  EXPECT_TRUE(json["deformation"].is_null());
  EXPECT_FALSE(json.contains("slam") || json.contains("merge") || json.contains("survey"));
}

TEST(BuildReport, AWalkHasItsLossesAndWeakSpots) {
  BuildSummary s = summary();
  s.is_partial = true;
  s.deformation = {0.03, 0.02};
  SlamSummary& slam = s.slam.emplace();
  slam.counts.num_views = 90, slam.counts.num_lost = 10, slam.counts.num_losses = 2, slam.counts.num_keyframes = 30;
  slam.counts.num_loops = 3, slam.counts.num_loops_refused = 1;
  slam.fit.median_px = 0.5, slam.fit.p90_px = 1.5, slam.fit.median_depth_m = 0.004;
  slam.up_problem = "no floor";
  for (std::uint64_t i = 0; i < 10; ++i) slam.weak_spots.push_back({100 * i, 100 * i + i, "lost", "go slower"});
  s.submaps = {{"", 2, 5}, {"room.2.cmap", 9, 40}};
  const std::string table = format_table(s);
  EXPECT_TRUE(contains(table, "80 of 90, lost 2 times")) << table;
  EXPECT_TRUE(contains(table, "30, of 3 views each")) << table;
  EXPECT_TRUE(contains(table, "3 closed, 1 refused")) << table;
  EXPECT_TRUE(contains(table, "median 0.50 px, 90 % below 1.50 px")) << table;
  EXPECT_TRUE(contains(table, "median 4.0 mm")) << table;
  EXPECT_TRUE(contains(table, "unknown (no floor)")) << table;
  EXPECT_TRUE(contains(table, "3.0 cm, 1.15 deg per axis (maps of half")) << table;
  EXPECT_TRUE(contains(table, "2 further segments")) << table;
  EXPECT_TRUE(contains(table, "(too short, left out)5 views")) << table;
  EXPECT_TRUE(contains(table, "weak spots (10, the longest shown)")) << table;
  EXPECT_FALSE(contains(table, "frames 0 to 0:")) << "the two shortest are left out";
  EXPECT_TRUE(contains(table, "frames 900 to 909: lost; go slower")) << table;
  EXPECT_TRUE(contains(table, "--resume goes on")) << table;
  const auto json = nlohmann::json::parse(format_json(s), nullptr, false);
  EXPECT_EQ(json["slam"]["lost"], 10);
  EXPECT_EQ(json["slam"]["loops"]["closed"], 3);
  EXPECT_EQ(json["slam"]["weak_spots"].size(), 10U);
  EXPECT_EQ(json["submaps"][1]["map"], "room.2.cmap");
  EXPECT_EQ(json["deformation"]["sigma_m"], 0.03);
  EXPECT_EQ(json["is_partial"], true);
}

TEST(BuildReport, TheVerticalIsTold) {
  BuildSummary s = summary();
  s.slam.emplace().up.emplace();
  s.slam->up->camera_height_m = 1.4;
  EXPECT_TRUE(contains(format_table(s), "from the floor, 1.40 m below the cameras"));
  EXPECT_FALSE(contains(format_table(s), "unit_m"));
  s.slam->up->camera_height_m = 6.96;
  s.notes = {"walk/rgb.txt: 1 image left out"};
  EXPECT_TRUE(contains(format_table(s), "WARNING the floor is 7.0 m below the cameras")) << format_table(s);
  EXPECT_TRUE(contains(format_table(s), "walk/rgb.txt: 1 image left out"));
  EXPECT_TRUE(contains(format_json(s), "is unit_m of the camera file right?"));
  s.slam->up->camera_height_m = 1.4;
  s.slam->up->source = GravitySource::kAccelerometer;
  s.slam->up->sigma_rad = 0.01745;
  EXPECT_TRUE(contains(format_table(s), "from the accelerometer, to 1.0 deg"));
  s.survey.emplace().is_written = true;
  EXPECT_TRUE(contains(format_table(s), "from control points"));
}

}  // namespace
}  // namespace camloc::mapping
