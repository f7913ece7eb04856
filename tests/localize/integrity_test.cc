// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// More evidence is never worth less, nothing is promised that nobody can promise, and radii follow the covariance.
#include "core/localize/integrity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace camloc {
namespace {

PoseEvidence good() {
  PoseEvidence evidence;
  evidence.num_matches = 210;
  evidence.num_inliers = 200;
  evidence.spread = 0.6;
  evidence.num_with_depth = evidence.num_map_depth = 200;
  return evidence;
}

Matrix6d covariance_of(double sigma_m, double sigma_rad) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variance.asDiagonal();
}

double risk_of(const PoseEvidence& evidence, const Standing& standing, bool is_tracked = false, double sigma_m = 0.01) {
  return integrity_risk(risk_features(evidence, standing, is_tracked), covariance_of(sigma_m, 0.005));
}

TEST(IntegrityTest, RiskIsAProbabilityWithALeastOne) {
  EXPECT_NEAR(risk_of(good(), {}), 1e-3, 2e-3);
  EXPECT_GE(risk_of(good(), {}, true, 1e-9), 1e-3);
  EXPECT_LT(risk_of({}, {.margin = -9, .lead = -50}), 1);
  EXPECT_GT(risk_of({}, {.margin = -9, .lead = -50}), 0.9);
  EXPECT_LT(risk_of(good(), {}, false, 1e6), 1);
}

TEST(IntegrityTest, MoreEvidenceIsNeverWorthLess) {
  const RiskFeatures some{0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0};
  for (std::size_t i = 0; i < kNumRiskFeatures; ++i) {
    RiskFeatures more = some;
    more[i] = 1;
    EXPECT_LE(fault_probability(more), fault_probability(some)) << risk_weights()[i + 1].name;
  }
  for (const RiskWeight& weight : risk_weights().subspan(1)) EXPECT_GE(weight.weight, 0) << weight.name;
}

TEST(IntegrityTest, FewInliersAWeakLeadAndALargeCovarianceAreRisks) {
  const double base = risk_of(good(), {});
  PoseEvidence thin = good();
  thin.num_inliers = 20;
  thin.num_matches = 40;
  EXPECT_GT(risk_of(thin, {}), 5 * base);
  EXPECT_GT(risk_of(good(), {.margin = 1, .lead = 0}), 5 * base);
  EXPECT_GT(risk_of(good(), {}, false, 0.1), 5 * base);
}

TEST(IntegrityTest, FeaturesAreSharesWhateverComesIn) {
  PoseEvidence odd = good();
  odd.spread = 7;
  odd.depth_agreement = -1;
  for (const double value : risk_features(odd, {.margin = 4, .lead = std::numeric_limits<double>::infinity()}, true)) {
    EXPECT_GE(value, 0);
    EXPECT_LE(value, 1);
  }
}

TEST(IntegrityTest, ProtectionIsOfTheWorstAxisAndGrowsWithTheShare) {
  Matrix6d covariance = covariance_of(0.01, 0.002);
  covariance(1, 1) = 0.04 * 0.04;
  const Protection protection = protection_of(covariance);
  EXPECT_GE(protection.p95.position_m, 1.9 * 0.04);
  EXPECT_GT(protection.p999.position_m, 4 * 0.04) << "heavier than a normal distribution";
  EXPECT_LT(protection.p999.position_m, 8 * 0.04);
  EXPECT_NEAR(protection.p999.rotation_rad / protection.p999.position_m, 0.002 / 0.04, 1e-9);
  covariance(0, 0) = std::nan("");
  EXPECT_GE(protection_of(covariance).p95.position_m, 1e3);
}

}  // namespace
}  // namespace camloc
