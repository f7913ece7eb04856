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

  CaptureOptions options_;
  UniqueFd wake_;
};

constexpr ErrorCode kFrame = ErrorCode::kOk;

TEST_F(CaptureThreadTest, RecordingEndsAfterItsLastFrame) {
  CaptureThread capture(options_, opener({kFrame, kFrame, kFrame, ErrorCode::kEnd}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kEnded; }));
  EXPECT_EQ(capture.num_received(), 3U);
  EXPECT_EQ(capture.mailbox().take()->buffer.sequence, 2U);
  EXPECT_TRUE(capture.report().was_open);
  EXPECT_EQ(capture.report().info.description, "scripted");
  EXPECT_TRUE(capture.stop(milliseconds(1000)));
}

TEST_F(CaptureThreadTest, CorruptFramesAndTimeoutsAreSkipped) {
  CaptureThread capture(options_, opener({ErrorCode::kCorrupt, ErrorCode::kTimeout, kFrame, ErrorCode::kCorrupt, kFrame, ErrorCode::kEnd}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.report().phase == CapturePhase::kEnded; }));
  EXPECT_EQ(capture.num_received(), 2U);
  EXPECT_EQ(capture.num_corrupt(), 2U);
}

TEST_F(CaptureThreadTest, VanishedDeviceIsOpenedAgain) {
  CaptureThread capture(options_, opener({kFrame, ErrorCode::kUnavailable}), wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.num_restarts() >= 3; }));
  EXPECT_GE(capture.num_received(), 3U);
}

TEST_F(CaptureThreadTest, MissingDeviceIsTriedAgainUntilItComes) {
  std::atomic<int> attempts{0};
  const auto open = [&](const std::string& url) -> Result<std::unique_ptr<FrameSource>> {
    EXPECT_EQ(url, "test://");
    if (++attempts < 4) return Status(ErrorCode::kUnavailable, "no device");
    return std::unique_ptr<FrameSource>(std::make_unique<ScriptedSource>(std::deque<ErrorCode>{kFrame}));
  };
  CaptureThread capture(options_, open, wake_.get());
  ASSERT_TRUE(wait_until([&] { return capture.num_received() == 1; }));
  EXPECT_EQ(capture.num_restarts(), 0U) << "the first success is no restart";
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
  ASSERT_TRUE(wait_until([&] { return capture.num_turns() > 5; }));
  EXPECT_EQ(capture.num_received(), 0U);
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
