// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said of a frame, with and without a pose, in the map and in the world.
#include "daemon/pose_report.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/daemon/sample_localization.h"

namespace camloc {
namespace {

using testing::localized;

TEST(PoseReportTest, AgeOfAnotherClockIsUnknown) {
  PoseReport out;
  Localization in = localized();
  PoseContext context;
  context.now_epoch_ns = in.stamp_ns - 1'000'000;
  out = make_pose_report(in, context);
  EXPECT_EQ(out.age_ns, -1) << "from the future";
  context.now_epoch_ns = in.stamp_ns + 60'000'000'000;
  out = make_pose_report(in, context);
  EXPECT_EQ(out.age_ns, -1) << "a minute old";
  context.now_epoch_ns = in.stamp_ns + 1'000;
  context.is_capture_clock_ours = false;
  out = make_pose_report(in, context);
  EXPECT_EQ(out.age_ns, -1) << "a recording";
}

TEST(PoseReportTest, StampsOfTheMonotonicClockBecomeTimeSinceTheEpoch) {
  Localization in = localized();
  in.stamp_ns = 5'000'000'000;  // seconds after the machine was started
  PoseContext context;
  context.stamp_to_epoch_ns = 1'700'000'000'000'000'000;
  context.now_epoch_ns = context.stamp_to_epoch_ns + in.stamp_ns + 12'000'000;
  const PoseReport out = make_pose_report(in, context);
  EXPECT_EQ(out.capture_epoch_ns, 1'700'000'005'000'000'000);
  EXPECT_EQ(out.age_ns, 12'000'000);
}

TEST(PoseReportTest, WorldPoseComesFromTheDatum) {
  const Localization in = localized();
  WcsDatum datum;
  datum.T_wcs_map.translation = {100, 200, 300};
  datum.T_wcs_map.rotation = exp_so3({0, 0, std::numbers::pi / 2});  // x of the map is y of the world
  PoseContext context;
  context.datum = &datum;
  const PoseReport out = make_pose_report(in, context);
  EXPECT_EQ(std::string(out.parent_frame), "wcs");
  EXPECT_NEAR(out.T_parent_camera.pose.translation[0], 100 - 2, 1e-12);
  EXPECT_NEAR(out.T_parent_camera.pose.translation[1], 200 + 1, 1e-12);
  EXPECT_NEAR(out.T_parent_camera.pose.translation[2], 303, 1e-12);
}

TEST(PoseReportTest, WithoutAPoseNothingLooksCertain) {
  Localization lost = localized();
  lost.has_pose = false;
  const PoseReport out = make_pose_report(lost, PoseContext{});
  EXPECT_EQ(out.quality, -1);
  EXPECT_EQ(out.T_parent_camera.pose.translation.norm(), 0);
  EXPECT_EQ(out.T_parent_camera.pose.rotation.w(), 1);
  EXPECT_EQ(out.T_parent_camera.covariance, Matrix6d(Matrix6d::Identity() * 1e6));
}

}  // namespace
}  // namespace camloc
