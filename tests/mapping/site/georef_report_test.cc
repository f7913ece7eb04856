// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The residual table and its JSON say what the fit says, of every point.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

GeorefSummary summary_of(int wrong = -1) {
  std::vector<GeorefPoint> points;
  const Rigid3 T{exp_so3({0, 0, 0.5}), {1000, 2000, 30}};
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p(5 * std::cos(2.4 * i), 4 * std::sin(2.4 * i), 0.4 * (i * 5 % 6));
    GeorefPoint& point = points.emplace_back();
    point.name = "P" + std::to_string(i);
    point.pair = {T * p, p, 0.01};
    if (i == wrong) point.pair.p_a.y() += 1;
  }
  GeorefSummary s;
  s.map_path = "m.cmap";
  s.out_path = "out.cmap";
  s.fit = fit_georef(points, {});
  return s;
}

TEST(GeorefReport, AGoodFitIsATableWithItsDatum) {
  GeorefSummary s = summary_of();
  s.is_written = s.has_replaced_datum = true;
  s.left_out = {"X, landmark 3: no such landmark"};
  s.only_in_points = {"A", "B"};
  const std::string table = format_table(s);
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(contains(table, "P" + std::to_string(i) + " ")) << table;
  EXPECT_TRUE(contains(table, "over 6 points")) << table;
  EXPECT_TRUE(contains(table, "position 1000.0000 2000.0000 30.0000 m, rotation wxyz 0.9689124 ")) << table;
  EXPECT_TRUE(contains(table, "left out      X, landmark 3")) << table;
  EXPECT_TRUE(contains(table, "not observed  A, B")) << table;
  EXPECT_TRUE(contains(table, "written       out.cmap (its older datum is replaced)")) << table;
}

TEST(GeorefReport, ASuspectHasItsResidualAndNothingIsWritten) {
  const GeorefSummary s = summary_of(2);
  EXPECT_FALSE(contains(format_table(s), "written       ")) << format_table(s);
  const auto json = nlohmann::json::parse(format_json(s), nullptr, false);
  ASSERT_EQ(json["points"].size(), 6U);
  EXPECT_EQ(json["points"][2]["verdict"], to_string(PointVerdict::kSuspect));
  EXPECT_NEAR(json["points"][2]["residual_m"][1].get<double>(), 1, 0.01);
  EXPECT_NEAR(json["points"][2]["predicted_error_m"][1].get<double>(), 1, 0.01);
  EXPECT_TRUE(contains(json["problem"].get<std::string>(), "P2"));
  EXPECT_TRUE(json["written"].is_null());
}

TEST(GeorefReport, WithoutAFitThereIsOnlyWhatWasFound) {
  GeorefSummary s;
  s.fit = fit_georef({}, {});
  s.only_in_observed = {"Z"};
  EXPECT_EQ(format_table(s), "not surveyed  Z\n");
  EXPECT_FALSE(nlohmann::json::parse(format_json(s), nullptr, false).contains("fit"));
}

}  // namespace
}  // namespace camloc::mapping
