// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses whose rates are known by construction.
#include "tools/evaluation/risk_report.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/tools/command_runner.h"
#include "tools/evaluation/judged_poses.h"
#include "tools/evaluation/risk_chart.h"
#include "tools/evaluation/risk_fit.h"

namespace camloc::tools {
namespace {

/// Wrong with the probability that a logistic model with `weight` on the inliers' feature says; promised as much.
std::vector<JudgedPose> generated(std::size_t count, double constant, double weight) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<JudgedPose> poses(count);
  for (JudgedPose& pose : poses) {
    pose.is_localized = true;
    pose.features[0] = uniform(random);
    pose.num_inliers = static_cast<std::uint32_t>(200 * pose.features[0]);
    pose.integrity_risk = 1 / (1 + std::exp(constant + weight * pose.features[0]));
    pose.is_misleading = uniform(random) < pose.integrity_risk;
    pose.nees = pose.is_misleading ? 100 : 6;
    pose.protection = {{0.02, 0.02}, {0.05, 0.05}};
    pose.error_m = pose.is_misleading ? 1 : 0.03;
    pose.sigma_m = pose.sigma_rad = 0.01;
  }
  return poses;
}

TEST(RiskReportTest, AnHonestPromiseIsObserved) {
  const auto poses = generated(40000, -1, 5);
  const RiskReport report = make_risk_report(poses, 50000);
  std::uint64_t total = 0;
  for (const RiskBin& bin : report.bins) {
    total += bin.num_poses;
    if (bin.num_poses < 500) continue;
    EXPECT_LT(bin.observed(), 1.6 * bin.promised) << bin.from;
    EXPECT_GT(bin.observed(), bin.promised / 1.6) << bin.from;
  }
  EXPECT_EQ(total, poses.size());
  EXPECT_NEAR(report.thresholds.back().availability, 0.8, 1e-9);
  EXPECT_EQ(report.all.protection_95, 0);
  EXPECT_GT(report.all.protection_999, report.hardest.protection_999) << "the wrong ones have few inliers";
  EXPECT_GT(report.nees.front().mean, report.nees.back().mean);
}

TEST(RiskFitTest, FindsTheModelThatMadeThePoses) {
  const RiskFit fit = fit_risk(generated(40000, -1, 5));
  EXPECT_NEAR(fit.weights[0], -1, 0.3);
  EXPECT_NEAR(fit.weights[1], 5, 0.5);
  EXPECT_EQ(fit_risk(generated(20000, 4, -5)).weights[1], 0) << "more evidence is never worth less";
}

TEST(RiskChartTest, IsDrawnAlsoOfNothing) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_risk_chart(make_risk_report({}, 0), folder / "empty.png").is_ok());
  EXPECT_TRUE(write_risk_chart(make_risk_report(generated(1000, -1, 5), 1000), folder / "some.png").is_ok());
  EXPECT_GT(std::filesystem::file_size(folder / "some.png"), std::filesystem::file_size(folder / "empty.png"));
}

TEST(JudgedPosesTest, WhatIsNoRecordFileIsOneLine) {
  const TemporaryFolder folder;
  const ReferencePose nowhere = [](std::int64_t) { return std::nullopt; };
  for (const char* text : {"", "[]", "{}", "{\"frames\": 3}", "{\"frames\": [{\"state\": 5}]}",
                           "{\"frames\": [{\"state\": \"LOCALIZED\"}]}", "{\"frames\": [{\"state\": \"LOCALIZED\", \"stamp\": 1}]}"}) {
    ASSERT_FALSE(folder.write("r.json", text).empty());
    const auto run = judge_records(folder / "r.json", nowhere, {});
    ASSERT_FALSE(run) << text;
    EXPECT_EQ(run.status().code(), ErrorCode::kInvalid) << text;
    EXPECT_EQ(run.status().message().find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace camloc::tools
