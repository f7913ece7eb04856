// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where somebody says the camera is: looked at first, verified like anything else, forgotten when it led nowhere.
#include "core/localize/hint_proposer.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

PoseHint hint_at(const Rigid3& T_map_camera, double radius_m = 0.5) {
  const Eigen::Vector3d axis = T_map_camera.rotation * Eigen::Vector3d::UnitZ();
  return {T_map_camera.translation, std::atan2(axis.y(), axis.x()), radius_m};
}

/// The room and its exact twin 20 m away: only who is told knows in which of them the camera is.
const testing::MapOnDisk& twin_rooms() {
  static const testing::MapOnDisk map(testing::with_copy({20, 0, 0}, [](std::uint32_t, const Eigen::Vector3d&) { return true; }));
  return map;
}

Rigid3 in_twin(Rigid3 T_map_camera) {
  T_map_camera.translation.x() += 20;
  return T_map_camera;
}

TEST(HintProposer, DecidesBetweenRoomsThatLookAlike) {
  const SampleWorld& world = SampleWorld::get();
  for (const bool is_twin : {false, true}) {
    Localizer localizer(*twin_rooms().view, world.camera(), {});
    ASSERT_EQ(localizer.process(world.frame(10).view()).reason, Reason::kAmbiguous);
    const Rigid3 truth = is_twin ? in_twin(sample_pose(11)) : sample_pose(11);
    localizer.hint(hint_at(truth));
    const Localization& result = localizer.process(world.frame(11).view());
    ASSERT_EQ(result.state, State::kLocalized) << is_twin;
    EXPECT_LT(pose_error(truth, result.T_map_camera).norm(), 0.02);
    EXPECT_FALSE(result.is_tracked);
    EXPECT_EQ(localizer.process(world.frame(12).view()).state, State::kLocalized) << "tracked from there";
  }
}

TEST(HintProposer, MayContradictTheMotionSoFar) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(*twin_rooms().view, world.camera(), {});
  localizer.hint(hint_at(sample_pose(10)));
  ASSERT_EQ(localizer.process(world.frame(10).view()).state, State::kLocalized);
  localizer.hint(hint_at(in_twin(sample_pose(11))));
  const Localization& result = localizer.process(world.frame(11).view());
  ASSERT_EQ(result.state, State::kLocalized);
  EXPECT_LT(pose_error(in_twin(sample_pose(11)), result.T_map_camera).norm(), 0.02);
  EXPECT_EQ(result.reset_counter, 2U);
  EXPECT_NEAR(result.jump_m, 20, 0.1);
}

TEST(HintProposer, AWrongHintNeitherMisleadsNorBlocks) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {});
  PoseHint wrong = hint_at(sample_pose(40));
  wrong.yaw_rad += 2.5;
  for (const Eigen::Vector3d& away : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(300, 0, 0)}) {
    PoseHint hint = wrong;
    hint.position_m += away;
    localizer.hint(hint);
    const Localization& result = localizer.process(world.frame(2).view());
    EXPECT_EQ(result.state, State::kLocalized) << "found by the other proposers";
    EXPECT_LT(pose_error(sample_pose(2), result.T_map_camera).norm(), 0.02);
    localizer.reset();
  }
}

TEST(HintProposer, NonsenseIsIgnoredAndOldHintsAreForgotten) {
  const SampleWorld& world = SampleWorld::get();
  const LocalizerNumbers numbers;
  const Gate gate(numbers, true);
  const FrameFeatures view;
  HintProposer proposer({&world.map(), &world.camera(), &numbers, 1000});
  const auto count = [&](std::int64_t stamp_ns) { return proposer.propose({stamp_ns, &view, &gate}).size(); };
  EXPECT_EQ(count(0), 0U);
  const PoseHint good = hint_at(sample_pose(30));
  for (int fault = 0; fault < 4; ++fault) {
    PoseHint bad = good;
    if (fault == 0) bad.position_m.y() = std::numeric_limits<double>::quiet_NaN();
    if (fault == 1) bad.yaw_rad = std::numeric_limits<double>::infinity();
    if (fault == 2) bad.radius_m = 0;
    if (fault == 3) bad.radius_m = 1e9;
    proposer.on_hint(bad);
    EXPECT_EQ(count(0), 0U) << fault;
  }
  proposer.on_hint(good);
  EXPECT_GT(count(1'000'000'000), 0U);
  EXPECT_GT(count(3'900'000'000), 0U);
  EXPECT_EQ(count(4'100'000'000), 0U) << "three seconds after it was first tried";
  proposer.on_hint(good);
  EXPECT_GT(count(5'000'000'000), 0U);
  proposer.on_accepted();
  EXPECT_EQ(count(5'000'000'001), 0U);
}

}  // namespace
}  // namespace camloc
