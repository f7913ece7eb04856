// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A walk with every misunderstanding that files of poses come with.
#include "core/mapmaking/pose_convention.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace camloc {
namespace {

constexpr int kPoses = 400;
constexpr std::int64_t kPeriodNs = 33'000'000;

Rigid3 true_pose(double t_s) {
  // A camera carried around a room: it looks about, nods and rolls a little, and goes faster and slower.
  const double yaw = 0.6 * t_s + 0.5 * std::sin(1.7 * t_s), pitch = 0.25 * std::sin(1.1 * t_s), roll = 0.1 * std::sin(2.3 * t_s);
  const Eigen::Quaterniond R_map_camera = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                          Eigen::AngleAxisd(-M_PI / 2 + pitch, Eigen::Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  return {R_map_camera, {2 * std::sin(0.4 * t_s) + 0.1 * std::sin(2.9 * t_s), 1.5 * std::cos(0.3 * t_s), 1.4 + 0.05 * std::sin(3.1 * t_s)}};
}

struct Walk {
  std::vector<GivenPose> poses;
  std::vector<SeenMotion> motions;
};

/// Registrations are off by some millimetres and tenths of a degree; `misread` makes the given pose of a true one.
Walk make_walk(const std::function<Rigid3(double t_s)>& given, std::uint64_t seed = 1) {
  std::mt19937 rng(static_cast<std::mt19937::result_type>(seed));
  std::normal_distribution<double> noise;
  const auto vector = [&](double sigma) { return Eigen::Vector3d(sigma * noise(rng), sigma * noise(rng), sigma * noise(rng)); };
  Walk walk;
  for (int i = 0; i < kPoses; ++i) walk.poses.push_back({i * kPeriodNs, given(1e-9 * static_cast<double>(i * kPeriodNs))});
  for (int i = 0; i + 8 < kPoses; i += 10) {
    const Rigid3 seen =
        true_pose(1e-9 * static_cast<double>(i * kPeriodNs)).inverse() * true_pose(1e-9 * static_cast<double>((i + 8) * kPeriodNs));
    const Rigid3 error{exp_so3(vector(0.003)), vector(0.004)};
    walk.motions.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(i + 8), seen * error});
  }
  return walk;
}

Rigid3 with_rotation(Rigid3 T, const Eigen::Quaterniond& R) {
  T.rotation = T.rotation * R;
  return T;
}

PoseVerdict verdict_of(const std::function<Rigid3(double t_s)>& given) {
  const Walk walk = make_walk(given);
  return judge_poses(walk.poses, walk.motions);
}

void expect_explained(const PoseVerdict& verdict, const std::string& part) {
  EXPECT_TRUE(verdict.is_contradicted());
  ASSERT_TRUE(verdict.fitting.has_value()) << verdict.given.score;
  EXPECT_NE(verdict.explanation.find(part), std::string::npos) << verdict.explanation;
  EXPECT_LT(verdict.fitting->score, 0.7);
}

TEST(PoseConvention, RightPosesAreLeftAlone) {
  const PoseVerdict verdict = verdict_of(true_pose);
  EXPECT_FALSE(verdict.is_contradicted());
  EXPECT_GT(verdict.num_motions, 30U);
  EXPECT_LT(verdict.given.score, 0.6);
  EXPECT_LT(verdict.sigma_m, 0.01);
  EXPECT_TRUE(verdict.explanation.empty());
}

TEST(PoseConvention, NoisyPosesWidenTheMapAndAreNotRefused) {
  std::mt19937 rng(3);
  std::normal_distribution<double> noise;
  const PoseVerdict verdict = verdict_of([&](double t_s) {
    Rigid3 T = true_pose(t_s);
    T.translation += 0.012 * Eigen::Vector3d(noise(rng), noise(rng), noise(rng));
    return T;
  });
  EXPECT_FALSE(verdict.is_contradicted());
  EXPECT_NEAR(verdict.sigma_m, 0.0175, 0.005) << "of the difference of two poses";
}

TEST(PoseConvention, NamesTheMisunderstanding) {
  expect_explained(verdict_of([](double t) { return true_pose(t).inverse(); }), "inverted: they take points of the map to the camera");
  const auto reordered = [](double t) {
    Rigid3 T = true_pose(t);
    const Eigen::Quaterniond q = T.rotation;
    T.rotation = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());  // w x y z in the file, read as x y z w
    return T;
  };
  expect_explained(verdict_of(reordered), "quaternion read as w x y z; the format");
  expect_explained(verdict_of([](double t) { return with_rotation(true_pose(t), Eigen::Quaterniond(0, 1, 0, 0)); }), "OpenGL's axes");
  expect_explained(verdict_of([](double t) { return with_rotation(true_pose(t), Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5)); }),
                   "robot's axes");
  expect_explained(verdict_of([](double t) { return true_pose(t - 0.3); }), "0.30 s behind");
  expect_explained(verdict_of([](double t) { return true_pose(t + 0.1); }), "0.10 s ahead of");
  const auto scaled = [](double t) {
    Rigid3 T = true_pose(t);
    T.translation *= 1000;
    return T;
  };
  expect_explained(verdict_of(scaled), "1e+03 times as long");
}

TEST(PoseConvention, PosesOfAnotherRecordingFitInNoWay) {
  const PoseVerdict verdict = verdict_of([](double t) { return true_pose(40 - 1.7 * t * (1 + 0.1 * std::sin(5 * t))); });
  EXPECT_TRUE(verdict.is_contradicted());
  EXPECT_TRUE(verdict.explanation.empty()) << verdict.explanation;
}

TEST(PoseConvention, WithoutMotionThereIsNoVerdict) {
  Walk walk = make_walk([](double t) { return true_pose(t).inverse(); });
  for (SeenMotion& motion : walk.motions) motion.T_from_to = Rigid3{};
  EXPECT_FALSE(judge_poses(walk.poses, walk.motions).is_contradicted());
  EXPECT_EQ(judge_poses(walk.poses, walk.motions).num_motions, 0U);
  EXPECT_FALSE(judge_poses({}, {}).is_contradicted());
}

}  // namespace
}  // namespace camloc
