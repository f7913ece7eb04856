// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers of an evaluation stand in the table and in the JSON where they belong.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

EvalSummary summary() {
  EvalSummary s;
  s.map_path = "m.cmap";
  s.cloud_name = "scan.ply";
  s.num_read = 1000, s.num_invalid = 10, s.num_points = 900;
  s.voxel_m = 0.01;
  s.min_observations = 2;
  Evaluation& e = s.evaluation;
  e.num_landmarks = 120, e.num_used = 100, e.num_keyframes = 8;
  e.start = AlignStart::kPoints;
  e.registration.emplace();
  e.registration->is_converged = true;
  e.registration->weakest_share = 0.2;
  e.registration->rms_m = 0.004;
  e.moved_m = 0.05;
  e.moved_rad = 0.1;
  e.T_cloud_map.translation = {1, 2, 3};
  e.T_cloud_map_start.translation = {4, 5, 6};
  e.residuals = {{"door", 0.01, {0.01, 0, 0}, {0, 0.07, 0}}};
  e.distances.point = {90, 0.011, 0.012, 0.013, 0.014, 0.015, 0.5, 0.9};
  e.distances.plane = {90, 0.021, 0.022, 0.023, 0.024, 0.025, 0.4, 0.8};
  e.distances.num_outside = 10;
  e.distances.num_cells = 50, e.distances.num_covered = 40;
  e.distances.map_extent_m = e.distances.cloud_extent_m = {8, 5, 2.6};
  e.scale = 1.002;
  return s;
}

TEST(EvalReport, TheTableHasEveryNumberInItsColumn) {
  const std::string table = format_table(summary());
  EXPECT_TRUE(contains(table, "100 of 120 with at least 2 observations, 8 keyframes")) << table;
  EXPECT_TRUE(contains(table, "1000 read, 10 of them invalid, 900 kept")) << table;
  EXPECT_TRUE(contains(table, "moved by 0.050 m, 5.73 deg")) << table;
  EXPECT_TRUE(contains(table, "4.0 mm RMS")) << table;
  EXPECT_TRUE(contains(table, "control point           fit [cm]  ICP [cm]\n  door                       1.0       7.0\n")) << table;
  EXPECT_TRUE(contains(table, "landmark to point                90    1.10    1.20    1.30    1.40    50.0    90.0")) << table;
  EXPECT_TRUE(contains(table, "landmark to surface              90    2.10    2.20    2.30    2.40    40.0    80.0")) << table;
  EXPECT_TRUE(contains(table, "10 of 100 landmarks (10.0 %)")) << table;
  EXPECT_TRUE(contains(table, "80.0 % of 50 cells")) << table;
  EXPECT_TRUE(contains(table, "1.0020 by ICP")) << table;
  EXPECT_FALSE(contains(table, "WARNING"));
}

TEST(EvalReport, JsonSaysTheSame) {
  EvalSummary s = summary();
  s.evaluation.scale = 1.1;
  const auto json = nlohmann::json::parse(format_json(s), nullptr, false);
  EXPECT_EQ(json["landmarks"]["used"], 100);
  EXPECT_EQ(json["alignment"]["start"], "control points");
  EXPECT_EQ(json["alignment"]["T_cloud_map"]["translation_m"], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(json["alignment"]["T_cloud_map_start"]["translation_m"], (std::vector<double>{4, 5, 6}));
  const auto& point = json["alignment"]["control_points"][0];
  EXPECT_EQ(point["residual_fit_m"], (std::vector<double>{0.01, 0, 0}));
  EXPECT_EQ(point["residual_icp_m"], (std::vector<double>{0, 0.07, 0}));
  EXPECT_EQ(json["distances"]["landmark_to_point"]["mean_m"], 0.011);
  EXPECT_EQ(json["distances"]["landmark_to_point"]["rms_m"], 0.013);
  EXPECT_EQ(json["distances"]["landmark_to_surface"]["p95_m"], 0.024);
  EXPECT_EQ(json["coverage"]["share"], 0.8);
  ASSERT_EQ(json["warnings"].size(), 1U);
  EXPECT_TRUE(contains(json["warnings"][0].get<std::string>(), "SCALE"));
  EXPECT_TRUE(contains(format_table(s), "WARNING SCALE"));
}

}  // namespace
}  // namespace camloc::mapping
