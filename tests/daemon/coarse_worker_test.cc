// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The worker with a network that the test plays, and once with a real one.
#include "daemon/coarse_worker.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>

#include "tests/coarse/sample_model.h"
#include "tests/daemon/process_allocations.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::TestFolder;

/// What the network was asked to do; shared with the worker's thread.
struct Played {
  std::atomic<int> num_loads{0}, num_loaded{0}, num_located{0};
  std::atomic<bool> is_held{false};
};

/// Counted as loaded for as long as it lives.
struct Token {
  explicit Token(Played* owner) : played(owner) { ++played->num_loaded; }
  ~Token() { --played->num_loaded; }
  Token(const Token&) = delete;
  Token& operator=(const Token&) = delete;
  Played* played;
};

CoarseWorkerOptions played_options(Played* played, std::int64_t idle_ns = 60'000'000'000) {
  CoarseWorkerOptions options;
  options.check = [] { return Status::ok(); };
  options.load = [played]() -> Result<LocateFrame> {
    ++played->num_loads;
    return LocateFrame([played, token = std::make_shared<Token>(played)](const Frame& frame) -> Result<CoarsePose> {
      while (played->is_held) std::this_thread::yield();
      ++played->num_located;
      if (frame.gray.at(0, 0) == 13) return Status(ErrorCode::kInvalid, "no pose");
      CoarsePose pose;
      pose.stamp_ns = frame.stamp_ns;
      pose.T_map_camera.translation.x() = frame.gray.at(3, 2);
      pose.covariance.setIdentity();
      return pose;
    });
  };
  options.idle_ns = idle_ns;
  options.color_width = options.depth_width = 64;
  options.color_height = options.depth_height = 48;
  return options;
}

FrameBuffer frame_of(std::int64_t stamp_ns, std::uint8_t gray) {
  FrameBuffer frame;
  frame.stamp_ns = stamp_ns;
  frame.gray.resize(64, 48);
  frame.depth.resize(64, 48);
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), gray);
  return frame;
}

/// Until it holds, or ten seconds are over.
template <typename Condition>
bool wait_for(Condition&& condition) {
  for (int i = 0; i < 10000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::optional<CoarseHint> wait_for_answer(CoarseWorker& worker) {
  std::optional<CoarseHint> hint;
  wait_for([&] { return (hint = worker.take()).has_value(); });
  return hint;
}

TEST(CoarseWorkerTest, LoadsWithTheFirstLostFrameAndAnswersForItsStamp) {
  Played played;
  CoarseWorker worker(played_options(&played));
  EXPECT_TRUE(wait_for([&] { return worker.phase() == CoarsePhase::kReady; }));
  EXPECT_EQ(played.num_loads, 0);
  worker.offer(frame_of(42, 7).view());
  const auto hint = wait_for_answer(worker);
  ASSERT_TRUE(hint);
  EXPECT_EQ(hint->stamp_ns, 42);
  EXPECT_EQ(hint->T_map_camera.translation.x(), 7);
  EXPECT_TRUE(hint->is_valid());
  EXPECT_FALSE(worker.take()) << "once";
  EXPECT_EQ(worker.phase(), CoarsePhase::kLoaded);
  EXPECT_EQ(worker.num_answers(), 1);
  worker.offer(frame_of(43, 8).view());
  EXPECT_EQ(wait_for_answer(worker)->stamp_ns, 43);
  EXPECT_EQ(played.num_loads, 1);
}

TEST(CoarseWorkerTest, GivesTheNetworkBackWhenNoFrameIsLostAnyMore) {
  Played played;
  CoarseWorker worker(played_options(&played, 20'000'000));
  for (int round = 1; round <= 2; ++round) {
    worker.offer(frame_of(1, 1).view());
    EXPECT_TRUE(wait_for_answer(worker));
    EXPECT_TRUE(wait_for([&] { return played.num_loaded == 0 && worker.phase() == CoarsePhase::kReady; }));
    EXPECT_EQ(played.num_loads, round);
  }
}

TEST(CoarseWorkerTest, TheFramePathNeitherWaitsNorAllocatesAndTheNewestFrameWins) {
  Played played;
  CoarseWorker worker(played_options(&played));
  const FrameBuffer first = frame_of(1, 1);
  FrameBuffer frame = frame_of(2, 2);
  played.is_held = true;
  worker.offer(first.view());
  ASSERT_TRUE(wait_for([&] { return played.num_loaded == 1; }));
  const bool can_count = testing::can_count_process_allocations();
  const std::uint64_t before = can_count ? testing::num_process_allocations() : 0;
  for (int i = 0; i < 100; ++i) {
    frame.stamp_ns = 100 + i;
    worker.offer(frame.view());
    EXPECT_FALSE(worker.take());
  }
  if (can_count) EXPECT_EQ(testing::num_process_allocations() - before, 0U);
  played.is_held = false;
  ASSERT_TRUE(wait_for([&] { return worker.num_answers() == 2; }));
  EXPECT_EQ(wait_for_answer(worker)->stamp_ns, 199);
  EXPECT_EQ(played.num_located, 2);
}

TEST(CoarseWorkerTest, AFrameWithoutAPoseIsNoFailure) {
  Played played;
  CoarseWorker worker(played_options(&played));
  worker.offer(frame_of(1, 13).view());
  ASSERT_TRUE(wait_for([&] { return played.num_located == 1; }));
  worker.offer(frame_of(2, 14).view());
  EXPECT_EQ(wait_for_answer(worker)->stamp_ns, 2);
  EXPECT_EQ(worker.phase(), CoarsePhase::kLoaded);
}

TEST(CoarseWorkerTest, WhatCannotBeLoadedIsTriedOnce) {
  for (const bool is_seen_at_once : {true, false}) {
    Played played;
    CoarseWorkerOptions options = played_options(&played);
    const auto fails = [&played] { return ++played.num_loads, Status(ErrorCode::kInvalid, "broken"); };
    if (is_seen_at_once) options.check = fails;
    options.load = [fails]() -> Result<LocateFrame> { return fails(); };
    CoarseWorker worker(options);
    for (int i = 0; i < 3; ++i) worker.offer(frame_of(i, 1).view());
    EXPECT_TRUE(wait_for([&] { return worker.phase() == CoarsePhase::kFailed; }));
    worker.offer(frame_of(9, 1).view());
    EXPECT_EQ(worker.problem(), "broken");
    EXPECT_FALSE(worker.take());
    EXPECT_EQ(played.num_loads, 1);
  }
}

TEST(CoarseWorkerTest, ModelsThatAreBrokenOrOfAnotherMapAreSaidInOneLine) {
  const TestFolder folder;
  RgbdCamera camera;
  camera.color = {64, 48, 58, 58, 31.5, 23.5, LensModel::kPinhole, {}};
  camera.depth = camera.color;
  ASSERT_TRUE(write_onnx(folder.file("good.onnx"), sample_onnx()));
  const auto problem = [&](const std::string& path, std::uint64_t map_id) {
    const Status status = coarse_worker_options(path, map_id, camera).check();
    EXPECT_EQ(status.message().find('\n'), std::string::npos);
    return status.message();
  };
  EXPECT_EQ(problem(folder.file("good.onnx"), 0xAB), "");
  EXPECT_NE(problem(folder.file("good.onnx"), 0xAC).find("00000000000000ac"), std::string::npos);
  EXPECT_NE(problem(folder.file("none.onnx"), 0xAB), "");
  std::filesystem::resize_file(folder.file("good.onnx"), 400);
  EXPECT_NE(problem(folder.file("good.onnx"), 0xAB).find("good.onnx"), std::string::npos);
}

// ThreadSanitizer does not see what OpenCV, which is not instrumented, does in the worker.
#if defined(CAMLOC_NETWORK_PLUGIN_FILE) && !defined(__SANITIZE_THREAD__)
TEST(CoarseWorkerTest, ARealNetworkAnswers) {
  const TestFolder folder;
  ASSERT_TRUE(write_onnx(folder.file("good.onnx"), sample_onnx()));
  RgbdCamera camera;
  camera.color = {64, 48, 58, 58, 31.5, 23.5, LensModel::kPinhole, {}};
  camera.depth = camera.color;
  ::setenv("CAMLOC_NETWORK_PLUGIN", CAMLOC_NETWORK_PLUGIN_FILE, 1);
  CoarseWorker worker(coarse_worker_options(folder.file("good.onnx"), 0xAB, camera));
  worker.offer(frame_of(5, 255).view());
  const auto hint = wait_for_answer(worker);
  ASSERT_TRUE(hint) << worker.problem();
  EXPECT_NEAR(hint->T_map_camera.translation.x(), 1 + 0.5 * 127.5 / 64, 1e-5);
  ::unsetenv("CAMLOC_NETWORK_PLUGIN");
}
#endif

}  // namespace
}  // namespace camloc
