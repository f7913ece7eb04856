// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The capture thread against sources that end, break, vanish and hang.
#include "daemon/capture_thread.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <deque>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

using std::chrono::milliseconds;

/// Says one after the other what it was told to: kOk is a frame.
class ScriptedSource : public FrameSource {
 public:
  explicit ScriptedSource(std::deque<ErrorCode> script) : script_(std::move(script)) { info_.description = "scripted"; }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] Status next(FrameBuffer* frame, milliseconds timeout) override {
    if (script_.empty()) {
      std::this_thread::sleep_for(std::min(timeout, milliseconds(5)));
      return {ErrorCode::kTimeout, "silent"};
    }
    const ErrorCode code = script_.front();
    script_.pop_front();
    if (code != ErrorCode::kOk) return {code, "scripted"};
    frame->sequence = sequence_++;
    return Status::ok();
  }

 private:
  std::deque<ErrorCode> script_;
  FrameSourceInfo info_;
  std::uint64_t sequence_ = 0;
};

/// Ignores its timeout until released.
class HangingSource : public ScriptedSource {
 public:
  HangingSource(std::atomic<bool>* hangs, std::atomic<bool>* released) : ScriptedSource({}), hangs_(hangs), released_(released) {}
  [[nodiscard]] Status next(FrameBuffer*, milliseconds) override {
    *hangs_ = true;
    while (!*released_) std::this_thread::sleep_for(milliseconds(1));
    return {ErrorCode::kUnavailable, "released"};
  }

 private:
  std::atomic<bool>*hangs_, *released_;
};

/// A live camera that delivers `num_frames` each time it is started and then falls silent. What cures it is told.
class SilentSource : public FrameSource {
 public:
  struct Device {
    RecoveryStep cure = RecoveryStep::kRestartStream;
    bool can_restart = true;
    std::atomic<bool> is_cured{false};
    std::atomic<int> restarts{0}, resets{0}, opens{0};
  };
  SilentSource(Device* device, int num_frames) : device_(device), num_frames_(num_frames) {
    info_.description = "silent";
    info_.stamp_clock = StampClock::kMonotonic;
    if (++device->opens > 1 && device->cure == RecoveryStep::kReopen) device->is_cured = true;
  }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] Status next(FrameBuffer* frame, milliseconds timeout) override {
    if (num_frames_ <= 0 && !device_->is_cured) {
      std::this_thread::sleep_for(timeout);
      return {ErrorCode::kTimeout, "silent"};
    }
    std::this_thread::sleep_for(milliseconds(1));
    --num_frames_;
    frame->sequence = sequence_++;
    return Status::ok();
  }
  [[nodiscard]] FrameSourceHealth health() const override {
    FrameSourceHealth health;
    health.packets_lost = 7;
    return health;
  }
  [[nodiscard]] Status restart() override {
    ++device_->restarts;
    if (!device_->can_restart) return {ErrorCode::kUnavailable, "no answer"};
    if (device_->cure == RecoveryStep::kRestartStream) device_->is_cured = true;
    return Status::ok();
  }
  [[nodiscard]] Status reset_device() override {
    ++device_->resets;
    if (device_->cure == RecoveryStep::kResetDevice) device_->is_cured = true;
    return Status::ok();
  }

 private:
  Device* device_;
  int num_frames_;
  FrameSourceInfo info_;
  std::uint64_t sequence_ = 0;
};

class CaptureThreadTest : public ::testing::Test {
 protected:
  CaptureThreadTest() : wake_(::eventfd(0, EFD_CLOEXEC)) {
    options_.url = "test://";
    options_.retry = milliseconds(5);
  }
  /// Waits for wake-ups until the condition holds; generous, only to end a broken run.
  template <typename Condition>
  bool wait_until(Condition condition) {
    for (int i = 0; i < 20000 && !condition(); ++i) {
      pollfd ready{wake_.get(), POLLIN, 0};
      if (::poll(&ready, 1, 1) > 0) {
        std::uint64_t count = 0;
        EXPECT_EQ(::read(wake_.get(), &count, sizeof(count)), 8);
      }
    }
    return condition();
  }
  static OpenSource opener(std::deque<ErrorCode> script) {
    return [script](const std::string&) -> Result<std::unique_ptr<FrameSource>> {
      return std::unique_ptr<FrameSource>(std::make_unique<ScriptedSource>(script));
    };
  }

  static OpenSource opener_of(SilentSource::Device* device) {
    return [device](const std::string&) -> Result<std::unique_ptr<FrameSource>> {
      return std::unique_ptr<FrameSource>(std::make_unique<SilentSource>(device, device->opens == 0 ? 5 : 0));
    };
  }
  /// Runs until frames come again after the stall; the counts of that moment.
  CaptureCounts recover(SilentSource::Device* device) {
    options_.supervisor.stall_ns = 20'000'000;
    options_.supervisor.first_frame_ns = 20'000'000;
    CaptureThread capture(options_, opener_of(device), wake_.get());
    EXPECT_TRUE(wait_until([&] { return capture.counts().stalls > 0 && capture.counts().frames_received > 10; }));
    EXPECT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kStreaming; }));
    return capture.counts();
  }

  CaptureOptions options_;
  UniqueFd wake_;
};

constexpr ErrorCode kFrame = ErrorCode::kOk;

TEST_F(CaptureThreadTest, RecordingEndsAfterItsLastFrame) {
  CaptureThread capture(options_, opener({kFrame, kFrame, kFrame, ErrorCode::kEnd}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kEnded; }));
  EXPECT_EQ(capture.counts().frames_received, 3U);
  EXPECT_EQ(capture.mailbox().take()->buffer.sequence, 2U);
  EXPECT_TRUE(capture.report().was_open);
  EXPECT_EQ(capture.report().info.description, "scripted");
  EXPECT_TRUE(capture.stop(milliseconds(1000)));
}

TEST_F(CaptureThreadTest, CorruptFramesAndTimeoutsAreSkipped) {
  CaptureThread capture(options_, opener({ErrorCode::kCorrupt, ErrorCode::kTimeout, kFrame, ErrorCode::kCorrupt, kFrame, ErrorCode::kEnd}),
                        wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kEnded; }));
  EXPECT_EQ(capture.counts().frames_received, 2U);
  EXPECT_EQ(capture.counts().frames_corrupt, 2U);
}

TEST_F(CaptureThreadTest, VanishedDeviceIsOpenedAgain) {
  CaptureThread capture(options_, opener({kFrame, ErrorCode::kUnavailable}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.counts().device_reopens >= 3; }));
  EXPECT_GE(capture.counts().frames_received, 3U);
}

TEST_F(CaptureThreadTest, MissingDeviceIsTriedAgainUntilItComes) {
  std::atomic<int> attempts{0};
  const auto open = [&](const std::string& url) -> Result<std::unique_ptr<FrameSource>> {
    EXPECT_EQ(url, "test://");
    if (++attempts < 4) return Status(ErrorCode::kUnavailable, "no device");
    return std::unique_ptr<FrameSource>(std::make_unique<ScriptedSource>(std::deque<ErrorCode>{kFrame}));
  };
  CaptureThread capture(options_, open, wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.counts().frames_received == 1; }));
  EXPECT_EQ(capture.counts().device_reopens, 0U) << "the first success is no restart";
  EXPECT_EQ(capture.report().phase, CapturePhase::kStreaming);
}

TEST_F(CaptureThreadTest, ProblemIsReported) {
  options_.retry = milliseconds(60000);
  const auto open = [](const std::string&) -> Result<std::unique_ptr<FrameSource>> { return Status(ErrorCode::kUnavailable, "no device"); };
  CaptureThread capture(options_, open, wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report_number() == 1; }));
  EXPECT_EQ(capture.report().phase, CapturePhase::kUnavailable);
  EXPECT_EQ(capture.report().problem, "no device");
  EXPECT_TRUE(capture.stop(milliseconds(5000))) << "stopping does not wait for the retry";
}

TEST_F(CaptureThreadTest, LosslessWaitsForTheReader) {
  options_.wait_for_reader = true;
  CaptureThread capture(options_, opener({kFrame, kFrame, kFrame, kFrame, kFrame, ErrorCode::kEnd}), wake_.get());
  for (std::uint64_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(wait_until([&] { return capture.mailbox().has_unread(); }));
    EXPECT_EQ(capture.mailbox().take()->buffer.sequence, i);
  }
  EXPECT_EQ(capture.mailbox().num_dropped(), 0U);
}

TEST_F(CaptureThreadTest, LosslessStopsWithoutAReader) {
  options_.wait_for_reader = true;
  CaptureThread capture(options_, opener({kFrame, kFrame, kFrame}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.mailbox().has_unread(); }));
  EXPECT_TRUE(capture.stop(milliseconds(5000)));
}

TEST_F(CaptureThreadTest, TurnsGoOnWhileNothingArrives) {
  CaptureThread capture(options_, opener({}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.counts().turns > 5; }));
  EXPECT_EQ(capture.counts().frames_received, 0U);
}

TEST_F(CaptureThreadTest, SilentCameraIsRestarted) {
  SilentSource::Device device;
  const CaptureCounts counts = recover(&device);
  EXPECT_GE(counts.stream_restarts, 1U);
  EXPECT_EQ(device.opens, 1) << "nothing rougher than needed";
  EXPECT_EQ(counts.device_resets, 0U);
  EXPECT_GE(counts.last_recovery_ns, options_.supervisor.stall_ns);
}

TEST_F(CaptureThreadTest, CameraThatDoesNotRestartIsOpenedAgain) {
  for (const bool can_restart : {true, false}) {
    SilentSource::Device device;
    device.cure = RecoveryStep::kReopen;
    device.can_restart = can_restart;
    const CaptureCounts counts = recover(&device);
    EXPECT_GE(device.restarts, 1);
    EXPECT_GE(counts.device_reopens, 1U);
    EXPECT_EQ(counts.device_resets, 0U);
  }
}

TEST_F(CaptureThreadTest, CameraThatOpeningDoesNotHelpIsReset) {
  SilentSource::Device device;
  device.cure = RecoveryStep::kResetDevice;
  const CaptureCounts counts = recover(&device);
  EXPECT_GE(device.resets, 1);
  EXPECT_EQ(static_cast<int>(counts.device_resets), device.resets);
  EXPECT_GE(counts.device_reopens, 2U);
}

TEST_F(CaptureThreadTest, StallIsReportedWithItsReason) {
  SilentSource::Device device;
  device.cure = RecoveryStep::kNone;
  options_.supervisor.stall_ns = 20'000'000;
  CaptureThread capture(options_, opener_of(&device), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kStalled; }));
  EXPECT_NE(capture.report().problem.find("no frame for "), std::string::npos) << capture.report().problem;
  ASSERT_TRUE(wait_until([&] { return capture.counts().source.packets_lost == 7; }));
}

TEST_F(CaptureThreadTest, RecordingsKeepTheirPace) {
  options_.supervisor.stall_ns = 1'000'000;
  CaptureThread capture(options_, opener({kFrame}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.counts().turns > 20; }));
  EXPECT_EQ(capture.counts().stalls, 0U);
  EXPECT_EQ(capture.report().phase, CapturePhase::kStreaming);
}

TEST_F(CaptureThreadTest, HangingSourceIsAbandoned) {
  // Outlives the test, as the process does for the daemon.
  static std::atomic<bool> hangs{false};
  static std::atomic<bool> released{false};
  static std::atomic<bool> is_gone{false};
  struct Gone : HangingSource {
    using HangingSource::HangingSource;
    ~Gone() override { is_gone = true; }
  };
  const auto open = [](const std::string&) -> Result<std::unique_ptr<FrameSource>> {
    return std::unique_ptr<FrameSource>(std::make_unique<Gone>(&hangs, &released));
  };
  {
    CaptureThread capture(options_, open, wake_.get());
    ASSERT_TRUE(wait_until([] { return hangs.load(); }));
    EXPECT_FALSE(capture.stop(milliseconds(20)));
  }
  released = true;
  EXPECT_TRUE(wait_until([] { return is_gone.load(); }));
}

}  // namespace
}  // namespace camloc
