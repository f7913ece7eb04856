// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A live camera on its way to the disk: whatever happens, what was written is whole.
#include "tools/recording/recorder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "core/io/sequence.h"
#include "tests/tools/command_runner.h"
#include "tests/tools/live_source.h"

namespace camloc::tools {
namespace {

class RecorderTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string out_ = folder_ / "walk";
};

TEST_F(RecorderTest, LiveStampsAreMovedToTheEpoch) {
  LiveSource source(5);
  source.skip_after_ = 2;
  RecordingFolder folder = make_folder(out_);
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const RecordingSummary summary = record(&source, &folder, {}, {});
  EXPECT_TRUE(summary.end.is_ok()) << summary.end.message();
  EXPECT_EQ(summary.frames, 5U);
  EXPECT_EQ(summary.missed, 5U) << "the numbers jump";
  EXPECT_EQ(summary.health.frames_incomplete, 3U);
  const auto sequence = read_sequence(out_);
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_NEAR(1e-9 * static_cast<double>(sequence->frames[0].stamp_ns), static_cast<double>(now.tv_sec), 30);
  const auto readings = read_accelerometer(out_ + "/accelerometer.txt");
  ASSERT_TRUE(readings.is_ok()) << readings.status().message();
  ASSERT_EQ(readings->size(), 5U);
  EXPECT_EQ((*readings)[0].stamp_ns, sequence->frames[0].stamp_ns);
  const Eigen::Vector3d a = kinect_R_camera_accelerometer() * (*readings)[0].acceleration;
  EXPECT_NEAR((a - Eigen::Vector3d(0.1, -9.8, 0.2)).norm(), 0, 1e-6);
}

TEST_F(RecorderTest, AFullQueueDropsCountsAndTells) {
  LiveSource source(200);
  source.size_ = 512;  // encoding takes longer than making a frame
  RecordingFolder folder = make_folder(out_);
  RecorderOptions options;
  options.queue_frames = options.num_writers = 1;
  std::uint64_t told = 0;
  RecorderHooks hooks;
  hooks.on_progress = [&told](const RecorderProgress& progress) { told = progress.dropped; };
  const RecordingSummary summary = record(&source, &folder, {}, options, hooks);
  EXPECT_GT(summary.dropped, 0U);
  EXPECT_EQ(told, summary.dropped);
  EXPECT_EQ(summary.frames + summary.dropped, 200U);
  EXPECT_EQ(all_frames(out_).size(), summary.frames);
}

TEST_F(RecorderTest, ADiskThatFillsUpEndsItWhole) {
  LiveSource source(100);
  RecordingFolder folder = make_folder(out_);
  RecorderHooks hooks;
  int calls = 0;
  hooks.free_bytes = [&calls](const std::string&) -> Result<std::uint64_t> {
    return ++calls < 10 ? std::uint64_t{1} << 40 : std::uint64_t{1} << 20;
  };
  const RecordingSummary summary = record(&source, &folder, {}, {}, hooks);
  EXPECT_EQ(summary.end.code(), ErrorCode::kIo);
  EXPECT_NE(summary.end.message().find("1 MiB left"), std::string::npos) << summary.end.message();
  EXPECT_EQ(summary.frames, 10U) << "what was taken is written";
  EXPECT_EQ(all_frames(out_).size(), 10U);
}

TEST_F(RecorderTest, AWriteThatFailsEndsItWhole) {
  LiveSource source(1 << 20);
  RecordingFolder folder = make_folder(out_);
  RecorderHooks hooks;
  hooks.on_progress = [&](const RecorderProgress& progress) {
    std::error_code ignored;  // a writer may put a file there meanwhile; the next call removes that, too
    if (progress.frames >= 5) std::filesystem::remove_all(out_ + "/depth", ignored);
  };
  RecorderOptions options;
  options.queue_frames = 4;
  const RecordingSummary summary = record(&source, &folder, {}, options, hooks);
  EXPECT_EQ(summary.end.code(), ErrorCode::kIo);
  EXPECT_NE(summary.end.message().find("/depth/"), std::string::npos) << summary.end.message();
  EXPECT_GE(summary.frames, 5U);
  EXPECT_GE(summary.unwritten, 1U);
  std::set<std::string> named;
  std::ifstream index(out_ + "/rgb.txt");
  for (std::string line; std::getline(index, line);) {
    if (line[0] != '#') named.insert(line.substr(line.find(' ') + 1));
  }
  EXPECT_EQ(named.size(), summary.frames);
  for (const std::string& name : named) EXPECT_TRUE(std::filesystem::exists(out_ + "/" + name)) << name;
}

TEST_F(RecorderTest, AnInterruptionIsNoFailure) {
  LiveSource source(1 << 20);
  RecordingFolder folder = make_folder(out_);
  std::uint64_t frames = 0;
  RecorderHooks hooks;
  hooks.on_progress = [&frames](const RecorderProgress&) { ++frames; };
  hooks.is_interrupted = [&frames] { return frames >= 8; };
  RecorderOptions options;
  options.queue_frames = 100;
  const RecordingSummary summary = record(&source, &folder, {}, options, hooks);
  EXPECT_TRUE(summary.end.is_ok()) << summary.end.message();
  EXPECT_EQ(summary.frames, 8U);
  EXPECT_EQ(all_frames(out_).size(), 8U);
}

TEST_F(RecorderTest, ACameraThatGoesAwayOrIsSilentIsToldSo) {
  for (const ErrorCode code : {ErrorCode::kUnavailable, ErrorCode::kTimeout}) {
    LiveSource source(4);
    source.end_ = {code, "unplugged"};
    RecordingFolder folder = make_folder(out_ + std::to_string(static_cast<int>(code)));
    RecorderOptions options;
    options.max_silence_s = 0.3;
    const RecordingSummary summary = record(&source, &folder, {}, options);
    EXPECT_EQ(summary.end.code(), code);
    EXPECT_EQ(summary.frames, 4U);
  }
}

}  // namespace
}  // namespace camloc::tools
