// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings that no map can be made of, and weak spots of others.
#include <gtest/gtest.h>

#include "tools/mapping/build/recording_tracking.h"

namespace camloc::mapping {
namespace {

RgbdCamera test_camera() {
  RgbdCamera camera;
  camera.color.width = 64;
  camera.color.height = 48;
  camera.color.fx = camera.color.fy = 50;
  camera.depth = camera.color;
  return camera;
}

std::int64_t stamp_ns(std::uint64_t frame) { return 1'000'000'000 + static_cast<std::int64_t>(frame) * 100'000'000; }

FrameReport tracked(int num_inliers = 200) {
  FrameReport report;
  report.state = ViewState::kTracked;
  report.num_inliers = num_inliers;
  return report;
}

/// Frames whose depth is a plane at a slant, or everywhere the same.
void see(RecordingCheck* check, std::uint64_t frame, std::uint16_t constant, std::size_t num_with_depth) {
  FrameBuffer buffer;
  buffer.sequence = frame;
  buffer.stamp_ns = stamp_ns(frame);
  buffer.gray.resize(64, 48);
  buffer.depth.resize(64, 48);
  for (std::size_t i = 0; i < buffer.depth.pixels.size(); ++i)
    buffer.depth.pixels[i] = static_cast<std::uint16_t>(constant != 0 ? constant : 1000 + i % 640);
  check->see_frame(buffer.view(), 400, num_with_depth);
  check->see_report(tracked());
}

SlamResult moving(double metres, double radians = 0, std::uint32_t segment_of_last = 0) {
  SlamResult result;
  for (std::uint64_t i = 0; i <= 10; ++i) {
    SlamPose pose;
    pose.frame = i;
    pose.T_map_camera = {exp_so3({0, radians * static_cast<double>(i) / 10, 0}), {metres * static_cast<double>(i) / 10, 0, 0}};
    pose.segment = i == 10 ? segment_of_last : 0;
    result.poses.push_back(pose);
  }
  return result;
}

TEST(RecordingCheck, AGoodWalkHasNothingToSay) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 50; ++i) {
    see(&check, i, 0, 300);
    EXPECT_TRUE(check.early_verdict().is_ok());
  }
  EXPECT_TRUE(check.verdict(moving(2)).is_ok());
  EXPECT_TRUE(check.weak_spots().empty());
  EXPECT_EQ(check.num_stamp_jumps(), 0U);
}

TEST(RecordingCheck, ConstantDepthIsGivenUpEarlyWithItsValue) {
  RecordingCheck check(test_camera());
  std::uint64_t given_up = 0;
  for (std::uint64_t i = 0; i < 50 && given_up == 0; ++i) {
    see(&check, i, 1234, 300);
    if (!check.early_verdict().is_ok()) given_up = i;
  }
  EXPECT_GE(given_up, 20U);
  EXPECT_LE(given_up, 30U);
  const Status verdict = check.verdict(moving(2));
  EXPECT_EQ(verdict.code(), ErrorCode::kInvalid);
  EXPECT_NE(verdict.message().find("1234"), std::string::npos) << verdict.message();
}

TEST(RecordingCheck, ACoveredDepthCameraIsNoDepth) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 40; ++i) see(&check, i, 65535, 0);
  const Status verdict = check.early_verdict();
  EXPECT_EQ(verdict.code(), ErrorCode::kInvalid);
  EXPECT_NE(verdict.message().find("no feature has depth in 40 of 40"), std::string::npos) << verdict.message();
}

TEST(RecordingCheck, FramesWithoutFeaturesSayNothingAboutDepth) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 40; ++i) {
    check.see_view(i, stamp_ns(i), 0, 0);
    check.see_report(FrameReport{});
  }
  EXPECT_TRUE(check.early_verdict().is_ok());
  ASSERT_EQ(check.weak_spots().size(), 1U);
  EXPECT_EQ(check.weak_spots()[0].what, "little texture");
}

TEST(RecordingCheck, AFewFramesWithoutDepthAreForgiven) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 40; ++i) see(&check, i, i < 20 ? 65535 : 0, i < 20 ? 0 : 300);
  EXPECT_TRUE(check.early_verdict().is_ok());
  EXPECT_TRUE(check.verdict(moving(1)).is_ok());
}

TEST(RecordingCheck, ACameraThatStandsStillIsRefused) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 11; ++i) see(&check, i, 0, 300);
  const Status verdict = check.verdict(moving(0.02, 0.02));
  EXPECT_EQ(verdict.code(), ErrorCode::kInvalid);
  EXPECT_NE(verdict.message().find("stood still"), std::string::npos);
  EXPECT_NE(verdict.message().find("2.0 cm"), std::string::npos) << verdict.message();
  EXPECT_TRUE(check.verdict(moving(0.1)).is_ok());
  EXPECT_TRUE(check.verdict(moving(0, 0.2)).is_ok());  // only turned
}

TEST(RecordingCheck, LostAndThenSomewhereElseIsNotStandingStill) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 11; ++i) see(&check, i, 0, 300);
  EXPECT_TRUE(check.verdict(moving(0.0, 0.0, 1)).is_ok());
}

TEST(RecordingCheck, JumpsOfTheStampsAreCounted) {
  RecordingCheck check(test_camera());
  for (std::uint64_t i = 0; i < 20; ++i) {
    check.see_view(i, stamp_ns(i + (i >= 8 ? 30 : 0) + (i >= 15 ? 30 : 0)), 400, 300);
    check.see_report(tracked());
  }
  EXPECT_EQ(check.num_stamp_jumps(), 2U);
  const auto spots = check.weak_spots();
  ASSERT_EQ(spots.size(), 2U);
  EXPECT_EQ(spots[0].what, "time jump");
  EXPECT_EQ(spots[0].first_frame, 8U);
  EXPECT_EQ(spots[1].first_frame, 15U);
  EXPECT_NE(spots[0].advice.find("without gaps"), std::string::npos);
}

TEST(RecordingCheck, WeakSpotsAreStretchesWithAdvice) {
  RecordingCheck check(test_camera());
  FrameReport lost;
  for (std::uint64_t i = 0; i < 120; ++i) {
    const bool is_bare = i >= 20 && i < 30, is_dark = i >= 40 && i < 50, is_lost = i >= 60 && i < 72, is_thin = i >= 90 && i < 95;
    check.see_view(i, stamp_ns(i), is_bare ? 40 : 400, is_dark ? 10 : 300);
    check.see_report(is_lost && i != 65 ? lost : tracked(is_thin ? 35 : 200));  // one good view inside
  }
  const auto spots = check.weak_spots();
  ASSERT_EQ(spots.size(), 4U);
  const char* what[] = {"little texture", "little depth", "lost", "few landmarks found again"};
  const std::uint64_t first[] = {20, 40, 60, 90}, last[] = {29, 49, 71, 94};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(spots[i].what, what[i]);
    EXPECT_EQ(spots[i].first_frame, first[i]);
    EXPECT_EQ(spots[i].last_frame, last[i]);
    EXPECT_FALSE(spots[i].advice.empty());
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(spots[i].advice, spots[k].advice);
  }
}

TEST(RecordingCheck, TheBeginOfASegmentIsNotWeak) {
  RecordingCheck check(test_camera());
  FrameReport begun;
  begun.state = ViewState::kTracked;
  begun.has_begun_segment = true;
  check.see_view(0, stamp_ns(0), 400, 300);
  check.see_report(begun);
  EXPECT_TRUE(check.weak_spots().empty());
}

TEST(RecordingCheck, NothingSeenIsNoVerdict) {
  const RecordingCheck check(test_camera());
  EXPECT_TRUE(check.verdict({}).is_ok());
  EXPECT_TRUE(check.early_verdict().is_ok());
}

}  // namespace
}  // namespace camloc::mapping
