// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace camloc {
namespace {

constexpr std::int64_t kStepNs = 40'000'000;
const Eigen::Vector3d kVelocity(0.5, -0.2, 0.8);  // camera axes
const Eigen::Vector3d kTurn(0.3, -0.9, 0.2);
const Rigid3 kStart{exp_so3({0.4, 1.1, -0.7}), {3, -2, 1.5}};

Rigid3 step(double seconds) { return {exp_so3(kTurn * seconds), kVelocity * seconds}; }

/// Goes on from `T` with the same motion in camera axes for a number of steps of 40 ms.
Rigid3 after_steps(Rigid3 T, int count) {
  for (int i = 0; i < count; ++i) T = T * step(0.04);
  return T;
}

double difference(const Rigid3& a, const Rigid3& b) { return pose_error(a, b).norm(); }

Matrix6d covariance() { return Matrix6d(Vector6d(1e-4, 2e-4, 3e-4, 1e-5, 2e-5, 3e-5).asDiagonal()); }

TEST(MotionModel, KnowsNothingAtFirst) {
  const MotionModel model{LocalizerNumbers{}};
  EXPECT_FALSE(model.has_fix());
  EXPECT_TRUE(model.is_plausible(0, kStart)) << "anything is";
}

TEST(MotionModel, OneFixStaysWhereItIs) {
  MotionModel model{LocalizerNumbers{}};
  model.add_fix(7, kStart, covariance(), true);
  EXPECT_TRUE(model.has_fix());
  EXPECT_EQ(model.last_stamp_ns(), 7);
  EXPECT_EQ(difference(model.last_fix(), kStart), 0);
  EXPECT_EQ(difference(model.predict(7 + 5 * kStepNs), kStart), 0);
}

TEST(MotionModel, ConstantVelocityIsExact) {
  MotionModel model{LocalizerNumbers{}};
  Rigid3 T = kStart;
  for (int i = 0; i < 10; ++i) {
    if (i >= 2) { EXPECT_LT(difference(model.predict(i * kStepNs), T), 1e-12) << i; }
    model.add_fix(i * kStepNs, T, covariance(), i > 0);
    T = after_steps(T, 1);
  }
  EXPECT_LT(difference(model.predict(9 * kStepNs + kStepNs / 2), after_steps(kStart, 9) * step(0.02)), 1e-12) << "between frames";
  EXPECT_LT(difference(model.predict(9 * kStepNs), after_steps(kStart, 9)), 1e-12) << "at the fix itself";
}

TEST(MotionModel, JumpsAndLongGapsGiveNoVelocity) {
  MotionModel model{LocalizerNumbers{}};
  model.add_fix(0, kStart, covariance(), false);
  model.add_fix(kStepNs, after_steps(kStart, 1), covariance(), false);
  EXPECT_EQ(difference(model.predict(2 * kStepNs), after_steps(kStart, 1)), 0) << "not continuous";
  model.add_fix(2 * kStepNs, after_steps(kStart, 2), covariance(), true);
  EXPECT_GT(difference(model.predict(3 * kStepNs), after_steps(kStart, 2)), 0.01);
  model.add_fix(2 * kStepNs + 500'000'001, kStart, covariance(), true);
  EXPECT_EQ(difference(model.predict(2 * kStepNs + 600'000'000), kStart), 0) << "too long ago";
  model.add_fix(2 * kStepNs + 500'000'001, after_steps(kStart, 1), covariance(), true);
  EXPECT_TRUE(model.predict(4'000'000'000).translation.allFinite()) << "no time between two fixes: no velocity, no division";
}

TEST(MotionModel, StopsExtrapolatingAfterHalfASecond) {
  MotionModel model{LocalizerNumbers{}};
  model.add_fix(0, kStart, covariance(), true);
  model.add_fix(kStepNs, after_steps(kStart, 1), covariance(), true);
  const Rigid3 T_half_second = model.predict(kStepNs + 500'000'000);
  EXPECT_LT(difference(T_half_second, after_steps(kStart, 1) * step(0.5)), 1e-12);
  EXPECT_EQ(difference(model.predict(kStepNs + 3'000'000'000), T_half_second), 0);
}

TEST(MotionModel, UncertaintyGrowsAsTheOptionsSay) {
  const LocalizerNumbers options;
  MotionModel model{options};
  model.add_fix(0, kStart, covariance(), true);
  const auto expect_growth = [&](std::int64_t from_ns, double factor) {
    for (const double seconds : {0.0, 0.04, 0.2, 1.0}) {
      const Matrix6d grown = model.predict_covariance(from_ns + std::llround(seconds * 1e9));
      Vector6d added = Vector6d::Constant(std::pow(factor * options.speed_change_m_per_s * seconds, 2));
      added.tail<3>().setConstant(std::pow(factor * options.turn_change_rad_per_s * seconds, 2));
      EXPECT_LT((grown - covariance() - Matrix6d(added.asDiagonal())).cwiseAbs().maxCoeff(), 1e-12) << seconds;
    }
  };
  expect_growth(0, 3);  // the velocity is not known
  model.add_fix(kStepNs, after_steps(kStart, 1), covariance(), true);
  expect_growth(kStepNs, 1);
  EXPECT_LT((model.predict_covariance(0) - covariance()).norm(), 1e-12) << "never smaller than that of the fix";
}

TEST(MotionModel, PlausibleIsWhatACameraCanDo) {
  const LocalizerNumbers options;
  MotionModel model{options};
  model.add_fix(0, kStart, covariance(), true);
  const auto moved = [](double metres) { return Rigid3{kStart.rotation, kStart.translation + Eigen::Vector3d(0, metres, 0)}; };
  const auto turned = [](double rad) { return Rigid3{exp_so3({0, 0, rad}) * kStart.rotation, kStart.translation}; };
  for (const std::int64_t dt_ns : {kStepNs, 10 * kStepNs, -kStepNs}) {
    const double dt_s = std::abs(1e-9 * static_cast<double>(dt_ns));
    const double reach_m = options.max_speed_m_per_s * dt_s + 0.25, reach_rad = options.max_turn_rad_per_s * dt_s + 0.2;
    EXPECT_TRUE(model.is_plausible(dt_ns, moved(0.99 * reach_m)));
    EXPECT_FALSE(model.is_plausible(dt_ns, moved(1.01 * reach_m)));
    EXPECT_TRUE(model.is_plausible(dt_ns, turned(0.99 * reach_rad)));
    EXPECT_FALSE(model.is_plausible(dt_ns, turned(1.01 * reach_rad)));
  }
}

TEST(MotionModel, ExpectedIsWhereThePredictionSays) {
  const LocalizerNumbers options;
  MotionModel model{options};
  EXPECT_TRUE(model.is_expected(0, kStart, covariance()));
  model.add_fix(0, kStart, covariance(), true);
  model.add_fix(kStepNs, after_steps(kStart, 1), covariance(), true);
  const Rigid3 T = model.predict(2 * kStepNs);
  const Matrix6d pose_covariance = 4 * covariance();
  const Vector6d variance = (model.predict_covariance(2 * kStepNs) + pose_covariance).diagonal();
  const double reach_m = options.expected_sigmas * std::sqrt(variance.head<3>().maxCoeff());
  const double reach_rad = options.expected_sigmas * std::sqrt(variance.tail<3>().maxCoeff());
  for (const double share : {0.98, 1.02}) {
    const Rigid3 moved{T.rotation, T.translation + Eigen::Vector3d(0, share * reach_m, 0)};
    const Rigid3 turned{exp_so3({0, 0, share * reach_rad}) * T.rotation, T.translation};
    EXPECT_EQ(model.is_expected(2 * kStepNs, moved, pose_covariance), share < 1);
    EXPECT_EQ(model.is_expected(2 * kStepNs, turned, pose_covariance), share < 1);
    EXPECT_TRUE(model.is_plausible(2 * kStepNs, moved)) << "far narrower";
  }
}

TEST(MotionModel, AVelocityOfLongAgoNarrowsNothing) {
  const LocalizerNumbers options;
  MotionModel model{options};
  model.add_fix(0, kStart, Matrix6d::Zero(), true);
  model.add_fix(kStepNs, after_steps(kStart, 1), Matrix6d::Zero(), true);
  const auto gap_ns = static_cast<std::int64_t>(1e9 * options.max_velocity_age_s);
  const std::int64_t stamp_ns = kStepNs + gap_ns;
  const double reach_m = options.expected_sigmas * options.speed_change_m_per_s * options.max_velocity_age_s;
  const Rigid3 T = model.predict(stamp_ns);
  const auto is_expected = [&](double moved_m) {
    return model.is_expected(stamp_ns, {T.rotation, T.translation + Eigen::Vector3d(0, moved_m, 0)}, Matrix6d::Zero());
  };
  EXPECT_TRUE(is_expected(2.9 * reach_m)) << "as without a velocity";
  EXPECT_FALSE(is_expected(3.1 * reach_m));
}

TEST(MotionModel, ResetForgetsAllButTheOptions) {
  LocalizerNumbers options;
  options.max_speed_m_per_s = 100;
  MotionModel model{options};
  model.add_fix(0, kStart, covariance(), true);
  model.add_fix(kStepNs, after_steps(kStart, 1), covariance(), true);
  model.reset();
  EXPECT_FALSE(model.has_fix());
  EXPECT_TRUE(model.is_plausible(0, {Eigen::Quaterniond::Identity(), {1000, 0, 0}}));
  model.add_fix(2 * kStepNs, kStart, covariance(), true);
  EXPECT_EQ(difference(model.predict(3 * kStepNs), kStart), 0) << "a continuation of nothing";
  EXPECT_TRUE(model.is_plausible(3 * kStepNs, {kStart.rotation, kStart.translation + Eigen::Vector3d(4, 0, 0)}));
}

}  // namespace
}  // namespace camloc
