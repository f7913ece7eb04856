// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The ladder of recovery, on a clock of the test's own.
#include "daemon/camera_supervisor.h"

#include <gtest/gtest.h>

#include <vector>

namespace camloc {
namespace {

constexpr std::int64_t kMs = 1'000'000;

SupervisorOptions options() { return {250 * kMs, 1500 * kMs, 5000 * kMs, 20'000 * kMs}; }

/// Steps taken while nothing arrives from `from_ns` to `to_ns`, with the times; a reopened camera opens at once.
std::vector<std::pair<std::int64_t, RecoveryStep>> silence(CameraSupervisor* supervisor, std::int64_t from_ns, std::int64_t to_ns) {
  std::vector<std::pair<std::int64_t, RecoveryStep>> steps;
  for (std::int64_t now_ns = from_ns; now_ns <= to_ns; now_ns += kMs) {
    const RecoveryStep step = supervisor->take_due_step(now_ns);
    if (step == RecoveryStep::kNone) continue;
    steps.emplace_back((now_ns - from_ns) / kMs, step);
    if (step != RecoveryStep::kRestartStream) supervisor->on_opened(now_ns, true);
  }
  return steps;
}

TEST(CameraSupervisorTest, SteadyFramesNeedNothing) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  for (int i = 1; i < 100; ++i) {
    EXPECT_EQ(supervisor.take_due_step(i * 33 * kMs), RecoveryStep::kNone);
    EXPECT_FALSE(supervisor.on_frame(i * 33 * kMs));
  }
}

TEST(CameraSupervisorTest, StallIsSeenWhenAFrameIsOverdue) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  supervisor.on_frame(1000 * kMs);
  EXPECT_EQ(supervisor.time_left_ns(1100 * kMs), 150 * kMs);
  EXPECT_EQ(supervisor.take_due_step(1249 * kMs), RecoveryStep::kNone);
  EXPECT_EQ(supervisor.take_due_step(1250 * kMs), RecoveryStep::kRestartStream);
  EXPECT_TRUE(supervisor.is_stalled());
}

TEST(CameraSupervisorTest, StepsBecomeRougherAndRarer) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  supervisor.on_frame(0);
  const auto steps = silence(&supervisor, 0, 200'000 * kMs);
  ASSERT_GE(steps.size(), 8U);
  EXPECT_EQ(steps[0], std::pair(std::int64_t{250}, RecoveryStep::kRestartStream));
  EXPECT_EQ(steps[1], std::pair(std::int64_t{1750}, RecoveryStep::kReopen));
  EXPECT_EQ(steps[2], std::pair(std::int64_t{3250}, RecoveryStep::kResetDevice));
  EXPECT_EQ(steps[3], std::pair(std::int64_t{6250}, RecoveryStep::kReopen));
  for (std::size_t i = 3; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].second, i % 2 == 1 ? RecoveryStep::kReopen : RecoveryStep::kResetDevice);
    EXPECT_GE(steps[i].first - steps[i - 1].first, steps[i - 1].first - steps[i - 2].first) << "never faster than before";
    EXPECT_LE(steps[i].first - steps[i - 1].first, 20'000) << "nor given up";
  }
}

TEST(CameraSupervisorTest, FrameEndsTheStallAndTheLadderStartsAnew) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  supervisor.on_frame(100 * kMs);
  EXPECT_EQ(silence(&supervisor, 100 * kMs, 4000 * kMs).size(), 3U);
  EXPECT_TRUE(supervisor.on_frame(4100 * kMs));
  EXPECT_EQ(supervisor.last_recovery_ns(), 4000 * kMs);
  EXPECT_FALSE(supervisor.on_frame(4133 * kMs));
  const auto again = silence(&supervisor, 4133 * kMs, 6000 * kMs);
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0], std::pair(std::int64_t{250}, RecoveryStep::kRestartStream));
  EXPECT_EQ(again[1], std::pair(std::int64_t{1750}, RecoveryStep::kReopen)) << "with the patience of the start";
}

TEST(CameraSupervisorTest, StepThatFailsIsFollowedAtOnce) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  EXPECT_EQ(supervisor.take_due_step(1500 * kMs), RecoveryStep::kRestartStream);
  supervisor.on_step_failed(1510 * kMs);
  EXPECT_EQ(supervisor.take_due_step(1510 * kMs), RecoveryStep::kReopen);
}

TEST(CameraSupervisorTest, FirstFrameMayTakeLonger) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  EXPECT_EQ(supervisor.take_due_step(1499 * kMs), RecoveryStep::kNone);
  EXPECT_EQ(supervisor.take_due_step(1500 * kMs), RecoveryStep::kRestartStream);
}

TEST(CameraSupervisorTest, CorruptFramesAreASignOfLifeForAWhile) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, true);
  supervisor.on_frame(0);
  std::int64_t stalled_at_ns = 0;
  for (std::int64_t now_ns = 33 * kMs; stalled_at_ns == 0 && now_ns < 20'000 * kMs; now_ns += 33 * kMs) {
    supervisor.on_corrupt_frame(now_ns);
    if (supervisor.take_due_step(now_ns) != RecoveryStep::kNone) stalled_at_ns = now_ns;
  }
  EXPECT_GE(stalled_at_ns, 5000 * kMs);
  EXPECT_LT(stalled_at_ns, 5100 * kMs);
}

TEST(CameraSupervisorTest, RecordingsAreLeftAlone) {
  CameraSupervisor supervisor(options());
  supervisor.on_opened(0, false);
  supervisor.on_frame(0);
  EXPECT_EQ(supervisor.take_due_step(3'600'000 * kMs), RecoveryStep::kNone);
  EXPECT_FALSE(supervisor.is_stalled());
}

}  // namespace
}  // namespace camloc
