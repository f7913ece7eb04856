// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What stands in a published message, with and without a pose, in the map and in the world.
#include "daemon/pose_publisher.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <limits>
#include <numbers>
#include <vector>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

Localization localized() {
  Localization localization;
  localization.sequence = 42;
  localization.stamp_ns = 1'700'000'000'123'456'789;
  localization.state = State::kLocalized;
  localization.reason = Reason::kNone;
  localization.has_pose = true;
  localization.T_map_camera.translation = {1, 2, 3};
  localization.T_map_camera.rotation = exp_so3({0.1, -0.2, 0.3});
  for (int i = 0; i < 36; ++i) localization.covariance(i / 6, i % 6) = i;
  localization.quality = 77;
  localization.num_features = 500;
  localization.num_matches = 300;
  localization.num_inliers = 200;
  localization.reset_counter = 2;
  localization.jump_m = 0.5;
  localization.stage_ns = {1000, 2000, 3000, 4000, 5000, 15000};
  return localization;
}

TEST(FillPoseTest, EveryFieldIsCarriedOver) {
  const Localization in = localized();
  PoseContext context;
  context.map_id = 0xfedcba9876543210;
  context.reset_offset = 5;
  context.now_epoch_ns = in.stamp_ns + 7'000'000;
  pose_t out{};
  fill_pose(in, context, &out);
  EXPECT_EQ(out.utime, 1'700'000'000'123'456);
  EXPECT_EQ(out.sequence, 42);
  EXPECT_EQ(static_cast<std::uint64_t>(out.map_id), context.map_id);
  EXPECT_EQ(out.parent_frame, "map");
  EXPECT_EQ(out.child_frame, "camera");
  EXPECT_EQ(out.pos[0], 1);
  EXPECT_EQ(out.pos[2], 3);
  EXPECT_EQ(out.orientation[0], in.T_map_camera.rotation.w());
  EXPECT_EQ(out.orientation[3], in.T_map_camera.rotation.z());
  for (int i = 0; i < 36; ++i) EXPECT_EQ(out.covariance[i], i) << "row-major";
  EXPECT_EQ(out.state, pose_t::LOCALIZED + 0);
  EXPECT_EQ(out.quality, 77);
  EXPECT_EQ(out.reason_text, "");
  EXPECT_EQ(out.num_features, 500);
  EXPECT_EQ(out.num_matches, 300);
  EXPECT_EQ(out.num_inliers, 200);
  EXPECT_EQ(out.reset_counter, 7);
  EXPECT_EQ(out.jump_m, 0.5);
  EXPECT_EQ(out.latency_us[0], 1);
  EXPECT_EQ(out.latency_us[5], 15);
  EXPECT_EQ(out.age_us, 7000);
}

TEST(FillPoseTest, StatesOfMessageAndLocalizerAgree) {
  EXPECT_EQ(pose_t::NO_CAMERA + 0, static_cast<int>(State::kNoCamera));
  EXPECT_EQ(pose_t::NO_MAP + 0, static_cast<int>(State::kNoMap));
  EXPECT_EQ(pose_t::LOST + 0, static_cast<int>(State::kLost));
  EXPECT_EQ(pose_t::COARSE + 0, static_cast<int>(State::kCoarse));
  EXPECT_EQ(pose_t::COASTING + 0, static_cast<int>(State::kCoasting));
}

TEST(FillPoseTest, WithoutAPoseNothingLooksCertain) {
  Localization lost = localized();
  lost.state = State::kLost;
  lost.reason = Reason::kFewMatches;
  lost.has_pose = false;
  pose_t out{};
  fill_pose(lost, PoseContext{}, &out);
  EXPECT_EQ(out.quality, -1);
  EXPECT_EQ(out.reason_text, to_string(Reason::kFewMatches));
  EXPECT_EQ(out.pos[0], 0);
  EXPECT_EQ(out.orientation[0], 1);
  for (int i = 0; i < 6; ++i) EXPECT_GE(out.covariance[7 * i], 1e6);
}

TEST(FillPoseTest, AgeOfAnotherClockIsUnknown) {
  Localization in = localized();
  PoseContext context;
  pose_t out{};
  context.now_epoch_ns = in.stamp_ns - 1'000'000;
  fill_pose(in, context, &out);
  EXPECT_EQ(out.age_us, -1) << "from the future";
  context.now_epoch_ns = in.stamp_ns + 60'000'000'000;
  fill_pose(in, context, &out);
  EXPECT_EQ(out.age_us, -1) << "a minute old";
  context.now_epoch_ns = in.stamp_ns + 1'000;
  context.is_capture_clock_ours = false;
  fill_pose(in, context, &out);
  EXPECT_EQ(out.age_us, -1) << "a recording";
}

TEST(FillPoseTest, StampsOfTheMonotonicClockBecomeTimeSinceTheEpoch) {
  Localization in = localized();
  in.stamp_ns = 5'000'000'000;  // seconds after the machine was started
  PoseContext context;
  context.stamp_to_epoch_ns = 1'700'000'000'000'000'000;
  context.now_epoch_ns = context.stamp_to_epoch_ns + in.stamp_ns + 12'000'000;
  pose_t out{};
  fill_pose(in, context, &out);
  EXPECT_EQ(out.utime, 1'700'000'005'000'000);
  EXPECT_EQ(out.age_us, 12'000);
}

TEST(FillPoseTest, NumbersAreClippedNotWrapped) {
  Localization in = localized();
  in.num_matches = std::numeric_limits<std::uint32_t>::max();
  in.quality = 1000;
  in.stage_ns[0] = std::numeric_limits<std::int64_t>::max();
  pose_t out{};
  fill_pose(in, PoseContext{}, &out);
  EXPECT_EQ(out.num_matches, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(out.latency_us[0], std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(out.quality, 100);
}

TEST(FillPoseTest, WorldPoseComesFromTheDatum) {
  const Localization in = localized();
  WcsDatum datum;
  datum.T_wcs_map.translation = {100, 200, 300};
  datum.T_wcs_map.rotation = exp_so3({0, 0, std::numbers::pi / 2});  // x of the map is y of the world
  PoseContext context;
  context.datum = &datum;
  pose_t out{};
  fill_pose(in, context, &out);
  EXPECT_EQ(out.parent_frame, "wcs");
  EXPECT_NEAR(out.pos[0], 100 - 2, 1e-12);
  EXPECT_NEAR(out.pos[1], 200 + 1, 1e-12);
  EXPECT_NEAR(out.pos[2], 303, 1e-12);
}

TEST(FillPoseTest, BotCoreHasPoseAndTimeOnly) {
  pose_t pose{};
  fill_pose(localized(), PoseContext{}, &pose);
  bot_core::pose_t out;
  out.vel[0] = 9;
  fill_bot_core(pose, &out);
  EXPECT_EQ(out.utime, pose.utime);
  EXPECT_EQ(out.pos[1], 2);
  EXPECT_EQ(out.orientation[0], pose.orientation[0]);
  EXPECT_EQ(out.vel[0], 0);
}

TEST(PosePublisherTest, UnknownProviderIsUnavailable) {
  PosePublisher publisher({"nonsense://", "P", "S", ""});
  EXPECT_EQ(publisher.connect().code(), ErrorCode::kUnavailable);
  EXPECT_FALSE(publisher.is_connected());
  EXPECT_FALSE(publisher.publish(localized(), PoseContext{}));
  EXPECT_EQ(publisher.num_poses_published(), 0U);
}

TEST(PosePublisherTest, MessagesArriveAndBotCoreOnlyWhenLocalized) {
  // LCM's file provider writes a log that can be read back without any network.
  char name[] = "/tmp/camloc_lcm_XXXXXX";
  const UniqueFd file(::mkstemp(name));
  {
    PosePublisher publisher({std::string("file://") + name + "?mode=w", "CAMLOC_POSE", "CAMLOC_STATUS", "POSE"});
    ASSERT_TRUE(publisher.connect());
    Localization localization = localized();
    EXPECT_TRUE(publisher.publish(localization, PoseContext{}));
    localization.state = State::kCoasting;
    EXPECT_TRUE(publisher.publish(localization, PoseContext{}));
    status_t status{};
    status.state_text = std::string(255, 't');
    status.source = status.map_path = std::string(1000, 'p');  // the longest that settings allow
    EXPECT_TRUE(publisher.publish(status));
    EXPECT_EQ(publisher.num_poses_published(), 2U);
  }
  std::vector<std::string> channels;
  lcm_eventlog_t* log = lcm_eventlog_create(name, "r");
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    channels.emplace_back(event->channel);
    if (channels.back() == "CAMLOC_POSE") {
      pose_t pose;
      EXPECT_EQ(pose.decode(event->data, 0, event->datalen), event->datalen);
      EXPECT_EQ(pose.sequence, 42);
    }
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  ::unlink(name);
  EXPECT_EQ(channels, (std::vector<std::string>{"CAMLOC_POSE", "POSE", "CAMLOC_POSE", "CAMLOC_STATUS"}));
}

}  // namespace
}  // namespace camloc
