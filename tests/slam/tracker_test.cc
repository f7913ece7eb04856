// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Tracking on a map of true keyframes: prediction, refusal, reference keyframes, finding back.
#include "core/slam/tracker.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;
using testing::TrueKeyframes;

/// Twelve keyframes around the room that share landmarks with their neighbours; tracking begins at the first. From
/// `second_segment` on they belong to another segment.
struct Fixture : TrueKeyframes {
  PlaceIndex places;
  Tracker tracker{SlamNumbers{}, &map, &solver};

  explicit Fixture(int second_segment = 12, const testing::World& of = testing::make_room(1, 90)) : TrueKeyframes(of) {
    for (int k = 0; k < 12; ++k) {
      const std::uint32_t keyframe = add(pose(0.2 * k), k < second_segment ? 0 : 1);
      if (k > 0 && k != second_segment) fuse_with_earlier(keyframe);
      places.add(map.keyframe(keyframe).view.features.descriptors);
    }
    tracker.set_reference(0);
    tracker.accept(stamp_ns(100), pose(0));
  }
  static Rigid3 pose(double yaw_rad) { return looking({0.3 * std::cos(yaw_rad), 0.3 * std::sin(yaw_rad), 1.4}, yaw_rad); }
  [[nodiscard]] std::int64_t stamp_ns(std::uint64_t frame) const { return viewer.blank(frame).stamp_ns; }
  void fuse_with_earlier(std::uint32_t keyframe) {
    LandmarkSet earlier = map.empty_landmark_set();
    const std::uint32_t before = keyframe - 1;
    map.collect_landmarks({&before, 1}, 4000, &earlier);
    fuse_into_keyframe(&earlier, keyframe, 4, &solver, &map);
  }
};

/// Fins of a radiator on the wall that the first keyframe looks at: every one like the next, 10 cm (19 px) apart.
testing::World room_with_radiator() {
  testing::World world = testing::make_room(1, 90);
  std::mt19937_64 rng(3);
  for (int row = 0; row < 14; ++row) {
    testing::WorldPoint point;
    point.normal = -Eigen::Vector3d::UnitX();
    point.descriptor = testing::random_descriptor(rng);
    for (int fin = 0; fin < 12; ++fin) {
      point.position_m = {2.95, 0.1 * fin - 0.55, 1.0 + 0.06 * row};
      world.points.push_back(point);
    }
  }
  return world;
}

double error_m(const Registration& found, const Rigid3& truth) { return (found.T_map_camera.translation - truth.translation).norm(); }

TEST(Tracker, FollowsAndChangesItsReference) {
  Fixture f;
  for (std::uint64_t i = 1; i <= 40; ++i) {
    const Rigid3 truth = Fixture::pose(0.03 * static_cast<double>(i));
    const FrameFeatures view = f.viewer.see(100 + i, truth);
    const Registration found = f.tracker.track(view, i);
    ASSERT_TRUE(found.is_found) << i;
    EXPECT_LT(error_m(found, truth), 0.015);
    f.tracker.accept(view.stamp_ns, found.T_map_camera);
    const Rigid3 kept = f.map.keyframe(f.tracker.reference()).view.T_map_camera * f.tracker.T_reference_camera();
    EXPECT_LT((kept.translation - found.T_map_camera.translation).norm(), 1e-9);
  }
  // 1.2 rad: the sixth keyframe is there.
  EXPECT_NEAR(f.tracker.reference(), 6, 1);
}

TEST(Tracker, PosesFollowTheirReferenceWhenItMoves) {
  Fixture f;
  const Rigid3 T_reference_camera = f.tracker.T_reference_camera();
  f.map.keyframe(0).view.T_map_camera.translation += Eigen::Vector3d(1, 0, 0);
  EXPECT_EQ(f.tracker.T_reference_camera().translation, T_reference_camera.translation);
  f.tracker.set_reference(1);  // the pose is the same, said by another keyframe
  const Rigid3 now = f.map.keyframe(1).view.T_map_camera * f.tracker.T_reference_camera();
  EXPECT_LT((now.translation - (Fixture::pose(0).translation + Eigen::Vector3d(1, 0, 0))).norm(), 1e-9);
}

// The windows around the prediction hold the neighbouring fin where they should hold the fin.
TEST(Tracker, ARepeatedPatternOnePeriodOffIsNotEnough) {
  Fixture f(12, room_with_radiator());
  const FrameFeatures before = f.viewer.see(101, Fixture::pose(0));
  const Registration at_first = f.tracker.track(before, 1);
  ASSERT_TRUE(at_first.is_found);
  f.tracker.accept(before.stamp_ns, at_first.T_map_camera);
  const Rigid3 truth{Fixture::pose(0).rotation, Fixture::pose(0).translation + Eigen::Vector3d(0, 0.1, 0)};
  const Registration found = f.tracker.track(f.viewer.see(102, truth), 2);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(error_m(found, truth), 0.015);
  EXPECT_GT(found.num_inliers, at_first.num_inliers / 2);
}

TEST(Tracker, AnImpossibleSpeedIsRefused) {
  Fixture f;
  // The same view as 0.1 s later from a place more than half a metre away.
  const Rigid3 far = looking({-0.6, 0, 1.4}, 0);
  const FrameFeatures at_once = f.viewer.see(101, far);
  EXPECT_FALSE(f.tracker.track(at_once, 1).is_found);
  const FrameFeatures later = f.viewer.see(105, far);
  const Registration found = f.tracker.track(later, 1);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(error_m(found, far), 0.02);
}

TEST(Tracker, NothingIsFoundInEmptyAndStrangeViews) {
  Fixture f;
  EXPECT_FALSE(f.tracker.track(f.viewer.blank(101), 1).is_found);
  EXPECT_FALSE(f.tracker.relocalize(f.viewer.blank(101), f.places, 1).is_found);
  const testing::World other = testing::make_room(60, 90);
  testing::Viewer elsewhere(other);
  EXPECT_FALSE(f.tracker.track(elsewhere.see(101, Fixture::pose(0)), 1).is_found);
  EXPECT_FALSE(f.tracker.relocalize(elsewhere.see(101, Fixture::pose(0)), f.places, 1).is_found);
  EXPECT_EQ(f.tracker.reference(), 0U);
}

TEST(Tracker, FindsBackAtAnyPlaceOfItsSegment) {
  Fixture f;
  const Rigid3 truth = Fixture::pose(1.55);
  const FrameFeatures view = f.viewer.see(130, truth);
  const Registration found = f.tracker.relocalize(view, f.places, 1);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(error_m(found, truth), 0.02);
  EXPECT_NEAR(f.tracker.reference(), 8, 1);
}

TEST(Tracker, DoesNotFindBackInAnotherSegment) {
  Fixture f(4);
  EXPECT_FALSE(f.tracker.relocalize(f.viewer.see(130, Fixture::pose(1.8)), f.places, 1).is_found);
}

TEST(Tracker, WantsAKeyframeWhenTheViewIsNew) {
  Fixture f;
  const auto wants = [&](const Rigid3& T) {
    const FrameFeatures view = f.viewer.see(101, T);
    Registration found;
    found.is_found = true;
    found.T_map_camera = T;
    found.inliers.resize(300);
    found.num_inliers = 300;
    return f.tracker.wants_keyframe(view, found);
  };
  EXPECT_FALSE(wants(Fixture::pose(0)));
  EXPECT_FALSE(wants(Fixture::pose(0.05)));
  EXPECT_TRUE(wants(looking(Fixture::pose(0).translation, 0.25)));  // turned
  EXPECT_TRUE(wants(looking({0.3, 0.4, 1.4}, 0)));                  // moved
  Registration few;
  few.T_map_camera = Fixture::pose(0);
  few.inliers.resize(40);
  EXPECT_TRUE(f.tracker.wants_keyframe(f.viewer.see(101, Fixture::pose(0)), few));
}

}  // namespace
}  // namespace camloc
