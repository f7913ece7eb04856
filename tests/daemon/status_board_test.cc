// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Counters, rate and latency of the status message.
#include "daemon/status_board.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(LatencyWindowTest, MedianMaximumAndRate) {
  LatencyWindow window(0);
  for (int i = 1; i <= 30; ++i) window.add(i * 1'000'000);
  const LatencyWindow::Summary summary = window.summarize(1'000'000'000);
  EXPECT_DOUBLE_EQ(summary.rate_hz, 30);
  EXPECT_DOUBLE_EQ(summary.p50_ms, 16);
  EXPECT_DOUBLE_EQ(summary.max_ms, 30);
}

TEST(LatencyWindowTest, EachWindowStartsEmpty) {
  LatencyWindow window(0);
  window.add(5'000'000);
  (void)window.summarize(1'000'000'000);
  const LatencyWindow::Summary summary = window.summarize(2'000'000'000);
  EXPECT_EQ(summary.rate_hz, 0);
  EXPECT_EQ(summary.p50_ms, 0);
  EXPECT_EQ(summary.max_ms, 0);
}

TEST(LatencyWindowTest, MoreFramesThanFitAreStillCounted) {
  LatencyWindow window(0);
  for (int i = 0; i < 5000; ++i) window.add(1'000'000);
  window.add(9'000'000);
  const LatencyWindow::Summary summary = window.summarize(1'000'000'000);
  EXPECT_DOUBLE_EQ(summary.rate_hz, 5001);
  EXPECT_DOUBLE_EQ(summary.p50_ms, 1);
  EXPECT_DOUBLE_EQ(summary.max_ms, 9);
}

TEST(LatencyWindowTest, NoTimeIsNoRate) {
  LatencyWindow window(5);
  window.add(1);
  EXPECT_EQ(window.summarize(5).rate_hz, 0);
}

TEST(StatusBoardTest, StateChangesAreTold) {
  StatusBoard board("sample://", "a.cmap", 0);
  EXPECT_EQ(board.state(), State::kNoCamera);
  EXPECT_TRUE(board.set_state(State::kLost, "why"));
  EXPECT_FALSE(board.set_state(State::kLost, "other reason"));
  EXPECT_EQ(board.get().state_text, "other reason");
  board.set_state(State::kLost, std::string(1000, 'x').c_str());
  EXPECT_EQ(board.get().state_text.size(), 255U);
}

TEST(StatusBoardTest, CountsWhatItIsTold) {
  StatusBoard board("sample://", "a.cmap", 1'000'000'000);
  Localization localization;
  localization.state = State::kLocalized;
  board.add_frame(localization, 2'000'000);
  localization.state = State::kLost;
  board.add_frame(localization, 4'000'000);
  board.set_map("b.cmap", 0x8000000000000001);
  board.close_window(2'000'000'000);
  board.stamp(3'000'000'000, 77'000);
  const DaemonStatus& status = board.get();
  EXPECT_EQ(status.frames_localized, 1);
  EXPECT_DOUBLE_EQ(status.frame_rate_hz, 2);
  EXPECT_DOUBLE_EQ(status.latency_max_ms, 4);
  EXPECT_EQ(status.source, "sample://");
  EXPECT_EQ(status.map_path, "b.cmap");
  EXPECT_EQ(status.map_id, 0x8000000000000001);
  EXPECT_EQ(status.focal_scale, 1);
  EXPECT_EQ(status.written_epoch_us, 77);
  EXPECT_EQ(status.uptime_us, 2'000'000);
  EXPECT_GT(status.rss_bytes, 100'000);
}

TEST(StatusBoardTest, CountsWhoFoundThePlace) {
  StatusBoard board("sample://", "map.cmap", 0);
  Localization pose;
  pose.state = State::kLocalized;
  for (const char* by : {"retrieval", "coarse", "coarse", "hint", "retrieval", "coarse"}) {
    pose.proposed_by = by;
    board.add_frame(pose, 1);
  }
  pose.is_tracked = true;
  board.add_frame(pose, 1);
  pose.is_tracked = false;
  pose.state = State::kLost;
  board.add_frame(pose, 1);
  EXPECT_EQ(board.get().fixes_by_coarse, 3);
  EXPECT_EQ(board.get().fixes_by_retrieval, 2);
  EXPECT_EQ(board.get().fixes_by_hint, 1);
}

}  // namespace
}  // namespace camloc
