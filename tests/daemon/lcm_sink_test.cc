// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What stands in a message on LCM, byte for byte, and which are sent.
#include "daemon/sinks/lcm_sink.h"

#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <stdlib.h>

#include <limits>
#include <vector>

#include "core/base/unique_fd.h"
#include "tests/daemon/sample_localization.h"

namespace camloc {
namespace {

using testing::localized;

pose_t message_of(const Localization& localization, const PoseContext& context) {
  pose_t message{};
  fill_pose(make_pose_report(localization, context), &message);
  return message;
}

PoseReport report_of(const Localization& localization) { return make_pose_report(localization, PoseContext{}); }

/// FNV-1a of the encoded message.
template <typename Message>
std::uint64_t hash_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

TEST(FillPoseTest, EveryFieldIsCarriedOver) {
  const Localization in = localized();
  PoseContext context;
  context.map_id = 0xfedcba9876543210;
  context.reset_offset = 5;
  context.now_epoch_ns = in.stamp_ns + 7'000'000;
  const pose_t out = message_of(in, context);
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
  EXPECT_EQ(out.integrity_risk, 0.01);
  EXPECT_EQ(out.protection_m[0], 0.03);
  EXPECT_EQ(out.protection_m[1], 0.06);
  EXPECT_EQ(out.protection_rad[0], 0.02);
  EXPECT_EQ(out.protection_rad[1], 0.04);
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
  const pose_t out = message_of(lost, PoseContext{});
  EXPECT_EQ(out.quality, -1);
  EXPECT_EQ(out.integrity_risk, 1);
  EXPECT_GE(out.protection_m[0], 1e3);
  EXPECT_GE(out.protection_rad[1], 1e3);
  EXPECT_EQ(out.reason_text, to_string(Reason::kFewMatches));
  EXPECT_EQ(out.pos[0], 0);
  EXPECT_EQ(out.orientation[0], 1);
  for (int i = 0; i < 6; ++i) EXPECT_GE(out.covariance[7 * i], 1e6);
}

TEST(FillPoseTest, NumbersAreClippedNotWrapped) {
  Localization in = localized();
  in.evidence.num_matches = std::numeric_limits<std::uint32_t>::max();
  in.quality = 1000;
  in.stage_ns[0] = std::numeric_limits<std::int64_t>::max();
  const pose_t out = message_of(in, PoseContext{});
  EXPECT_EQ(out.num_matches, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(out.latency_us[0], std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(out.quality, 100);
}

TEST(FillPoseTest, BotCoreHasPoseAndTimeOnly) {
  const pose_t pose = message_of(localized(), PoseContext{});
  bot_core::pose_t out;
  out.vel[0] = 9;
  fill_bot_core(pose, &out);
  EXPECT_EQ(out.utime, pose.utime);
  EXPECT_EQ(out.pos[1], 2);
  EXPECT_EQ(out.orientation[0], pose.orientation[0]);
  EXPECT_EQ(out.vel[0], 0);
}

// Subscribers out there decode these bytes: they may not change.
TEST(LcmSinkTest, BytesOnTheWireAreWhatTheyAlwaysWere) {
  Localization localization = localized();
  localization.T_map_camera.rotation = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5);
  PoseContext context;
  context.map_id = 0xfedcba9876543210;
  context.reset_offset = 5;
  context.now_epoch_ns = localization.stamp_ns + 7'000'000;
  const pose_t pose = message_of(localization, context);
  EXPECT_EQ(hash_of(pose), 0xca068644f29eaa72U);
  bot_core::pose_t bot_core_pose;
  fill_bot_core(pose, &bot_core_pose);
  EXPECT_EQ(hash_of(bot_core_pose), 0xebaf3fd62c3bff23U);
  localization.state = State::kLost;
  localization.reason = Reason::kFewMatches;
  localization.has_pose = false;
  EXPECT_EQ(hash_of(message_of(localization, context)), 0x23b6854ac7cf99dbU);
}

TEST(LcmSinkTest, EveryFieldOfTheStatusIsCarriedOver) {
  DaemonStatus in;
  in.written_epoch_us = 1;
  in.state = State::kLocalized;
  in.state_text = "text";
  in.source = "sample://";
  in.map_path = "a.cmap";
  in.map_id = 0xfedcba9876543210;
  std::int64_t number = 2;
  for (std::int64_t* field : {&in.uptime_us, &in.frames_received, &in.frames_dropped, &in.frames_corrupt, &in.frames_localized,
                              &in.poses_published, &in.reset_counter, &in.map_reloads, &in.map_reload_failures})
    *field = number++;
  in.camera_state = "streaming";
  for (std::int64_t* field : {&in.camera_stalls, &in.stream_restarts, &in.device_reopens, &in.device_resets}) *field = number++;
  in.last_recovery_ms = 0.5 + static_cast<double>(number++);
  for (std::int64_t* field : {&in.packets_lost, &in.frames_incomplete, &in.frames_unpaired}) *field = number++;
  for (double* field : {&in.clock_drift_ppm, &in.frame_rate_hz, &in.latency_p50_ms, &in.latency_max_ms})
    *field = 0.5 + static_cast<double>(number++);
  in.rss_bytes = number++;
  in.is_calibration_suspect = true;
  in.focal_scale = 1.25;
  status_t out{};
  fill_status(in, &out);
  EXPECT_EQ(hash_of(out), 0xc70274878d220302U);
}

TEST(LcmSinkTest, UnknownProviderIsUnavailable) {
  const auto sink = open_lcm_sink({"nonsense://", "P", "S", ""});
  ASSERT_TRUE(sink);
  EXPECT_EQ((*sink)->connect().code(), ErrorCode::kUnavailable);
  EXPECT_FALSE((*sink)->is_connected());
  EXPECT_FALSE((*sink)->publish(report_of(localized())));
}

TEST(LcmSinkTest, MessagesArriveAndBotCoreOnlyWhenLocalized) {
  // LCM's file provider writes a log that can be read back without any network.
  char name[] = "/tmp/camloc_lcm_XXXXXX";
  const UniqueFd file(::mkstemp(name));
  {
    const auto sink = open_lcm_sink({std::string("file://") + name + "?mode=w", "CAMLOC_POSE", "CAMLOC_STATUS", "POSE"});
    ASSERT_TRUE((*sink)->connect());
    Localization localization = localized();
    EXPECT_TRUE((*sink)->publish(report_of(localization)));
    localization.state = State::kCoasting;
    EXPECT_TRUE((*sink)->publish(report_of(localization)));
    DaemonStatus status;
    status.state_text = std::string(255, 't');
    status.source = status.map_path = std::string(1000, 'p');  // the longest that settings allow
    EXPECT_TRUE((*sink)->publish(status));
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
