// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Walks and buildings: possible for a person, the same and different where they should be.
#include "tools/camloc-sim/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/sensors.h"

namespace camloc::sim {
namespace {

/// Kind, day, seed.
class Walks : public ::testing::TestWithParam<std::tuple<SceneKind, std::uint32_t, std::uint32_t>> {
 protected:
  World world_ = make_world({std::get<0>(GetParam()), std::get<2>(GetParam()), std::get<1>(GetParam())});
};

TEST_P(Walks, AreSmoothAndUnhurried) {
  const Trajectory& walk = world_.trajectory;
  for (double t = 0.2; t < walk.duration_s() - 0.2; t += 0.05) {
    const Trajectory::Twist twist = walk.twist(t);
    ASSERT_LT(twist.linear.norm(), 1.25) << t;
    ASSERT_LT(twist.angular.norm(), 80.0 / 57.3) << t;
    const double height = walk.pose(t).translation.z();
    ASSERT_GT(height, 1.4);
    ASSERT_LT(height, 1.75);
  }
}

TEST_P(Walks, TwistIsTheDerivativeOfThePose) {
  const Trajectory& walk = world_.trajectory;
  for (const double t : {1.0, 5.3, 11.7}) {
    constexpr double kStep = 0.02;
    const Trajectory::Twist twist = walk.twist(t);
    const Rigid3 now = walk.pose(t), later = walk.pose(t + kStep);
    const Rigid3 predicted = now * Rigid3{exp_so3(twist.angular * kStep), twist.linear * kStep};
    EXPECT_LT((predicted.translation - later.translation).norm(), 2e-3);
    EXPECT_LT(rotation_distance_rad(predicted.rotation, later.rotation), 4e-3);
  }
}

TEST_P(Walks, NobodyWalksThroughAWall) {
  Eigen::Vector3d before = world_.trajectory.pose(0).translation;
  for (double t = 0.1; t < world_.trajectory.duration_s(); t += 0.1) {
    const Eigen::Vector3d after = world_.trajectory.pose(t).translation;
    for (const Surface& s : world_.scene.surfaces) {
      const double from = s.normal().dot(before - s.origin), to = s.normal().dot(after - s.origin);
      if (from * to > 0) continue;
      const Eigen::Vector3d offset = before + (after - before) * (from / (from - to + 1e-12)) - s.origin;
      const double u = offset.dot(s.u_axis), v = offset.dot(s.v_axis);
      ASSERT_FALSE(u > 0 && v > 0 && u < s.width && v < s.height) << "at " << t << " s, (" << after.transpose() << ")";
    }
    before = after;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Walks,
                         ::testing::Combine(::testing::Values(SceneKind::kSmall, SceneKind::kBuilding), ::testing::Values(1U, 2U),
                                            ::testing::Values(1U)));
INSTANTIATE_TEST_SUITE_P(OtherBuildings, Walks,
                         ::testing::Combine(::testing::Values(SceneKind::kBuilding), ::testing::Values(1U, 2U),
                                            ::testing::Values(2U, 3U, 77U)));

TEST(Building, AnotherSeedIsAnotherLayout) {
  const FloorPlan first = floor_plan(SceneKind::kBuilding, 2), second = floor_plan(SceneKind::kBuilding, 3);
  EXPECT_GT(std::abs(first.sides[0].length - second.sides[0].length), 0.1);
  const auto looks = [](const FloorPlan& plan) {
    std::map<std::uint32_t, int> count;
    for (const CorridorSide& side : plan.sides)
      for (const Stretch& stretch : side.stretches) ++count[stretch.look];
    return count;
  };
  for (const auto& [look, count] : looks(first)) EXPECT_FALSE(looks(second).contains(look));
  for (const FloorPlan& plan : {first, second}) {
    std::vector<int> repeated;
    for (const auto& [look, count] : looks(plan))
      if (count > 1) repeated.push_back(count);
    std::sort(repeated.begin(), repeated.end());
    EXPECT_EQ(repeated, (std::vector<int>{2, 3}));
  }
}

TEST(Building, TheLoopIsWalkedAllAround) {
  const World world = make_world({SceneKind::kBuilding, 1, 1});
  Eigen::AlignedBox3d bounds;
  for (double t = 0; t < world.trajectory.duration_s(); t += 0.5) bounds.extend(world.trajectory.pose(t).translation);
  EXPECT_LT(bounds.min().x(), 1.5);
  EXPECT_LT(bounds.min().y(), 1.5);
  EXPECT_GT(bounds.max().x(), 55.5);
  EXPECT_GT(bounds.max().y(), 38.5);
}

/// What hangs and stands static around (s, n) of a side, as the seeds of its surfaces.
std::map<std::uint32_t, int> looks_between(const World& world, int side, double from_s, double to_s) {
  std::map<std::uint32_t, int> result;
  const Placement& place = world.plan.sides[static_cast<std::size_t>(side)].place;
  for (const Surface& s : world.scene.surfaces) {
    const Eigen::Vector2d offset = s.at(0.5 * s.width, 0.5 * s.height).head<2>() - place.origin;
    const double along = offset.dot(place.direction(1, 0).head<2>()), across = offset.dot(place.direction(0, 1).head<2>());
    if (s.room == 0 && along > from_s && along < to_s && across > -0.01 && across < kCorridorWidth + 0.01) ++result[s.skin.seed];
  }
  return result;
}

TEST(Building, LookAlikeStretchesDifferOnlyBySigns) {
  const World world = make_world({SceneKind::kBuilding, 1, 1});
  const auto first = looks_between(world, 0, 10.0, 22.0), second = looks_between(world, 2, 10.0, 22.0),
             other = looks_between(world, 1, 24.0, 36.0);
  const auto share = [](const auto& a, const auto& b) {
    int common = 0, all = 0;
    for (const auto& [seed, count] : a) {
      all += count;
      const auto it = b.find(seed);
      if (it != b.end()) common += std::min(count, it->second);
    }
    return static_cast<double>(common) / all;
  };
  EXPECT_GT(share(first, second), 0.85);
  EXPECT_LT(share(first, second), 1.0);
  EXPECT_LT(share(first, other), share(first, second));
}

TEST(Building, AnotherDayMovesClutterAndNothingElse) {
  const FloorPlan plan = floor_plan(SceneKind::kSmall, 1);
  const Scene first = build_scene(plan, {SceneKind::kSmall, 1, 1}), second = build_scene(plan, {SceneKind::kSmall, 1, 2});
  std::vector<Eigen::Vector3d> fixed_first, fixed_second, loose_first, loose_second;
  for (const Surface& s : first.surfaces) (s.is_static ? fixed_first : loose_first).push_back(s.origin);
  for (const Surface& s : second.surfaces) (s.is_static ? fixed_second : loose_second).push_back(s.origin);
  EXPECT_EQ(fixed_first, fixed_second);
  EXPECT_NE(loose_first, loose_second);
}

TEST(People, ComeBetweenTheCameraAndTheBuildingOnOtherDaysOnly) {
  const World mapping = make_world({SceneKind::kBuilding, 1, 1}), other = make_world({SceneKind::kBuilding, 1, 2});
  EXPECT_TRUE(mapping.passers.empty());
  ASSERT_GE(other.passers.size(), 2U);
  const Passer& oncoming = other.passers.front();
  const std::vector<Surface> people = people_at(other, oncoming.meet_time_s - 2.0);
  Renderer renderer(other.scene, simulated_camera().color);
  const Rendering& rendering = renderer.render(other.trajectory.pose(oncoming.meet_time_s - 2.0), people);
  const auto num_static = static_cast<std::int32_t>(other.scene.surfaces.size());
  int num_pixels = 0;
  for (const std::int32_t id : rendering.surface.pixels) num_pixels += id >= num_static;
  EXPECT_GT(num_pixels, 3000);
}

}  // namespace
}  // namespace camloc::sim
