// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What `camloc record` writes is what replay:// reads, whatever happens in between.
#include <atomic>
#include <chrono>
#include <ctime>
#include <set>

#include "core/io/accelerometer.h"
#include "core/io/sequence.h"
#include "drivers/sample_source.h"
#include "drivers/sources.h"
#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"
#include "tools/recording/recorder.h"

namespace camloc::tools {
namespace {

using std::chrono::milliseconds;

std::vector<FrameBuffer> all_frames(const std::string& url, bool wants_color = false) {
  std::vector<FrameBuffer> frames;
  const auto source = open_frame_source(url, {wants_color});
  EXPECT_TRUE(source.is_ok()) << source.status().message();
  FrameBuffer frame;
  while (source && (*source)->next(&frame, milliseconds(1000))) frames.push_back(frame);
  return frames;
}

CommandOutput run_record(std::vector<std::string> options) {
  options.insert(options.begin(), "record");
  return run_command(add_record_command, options);
}

constexpr const char* kSample = "sample://?rate_hz=0&frames=12&width=160&height=120";

class RecordTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string out_ = folder_ / "walk";
};

TEST_F(RecordTest, ReplayGivesTheSameFrames) {
  for (const char* compression : {"fast", "small"}) {
    const CommandOutput output = run_record({"--source", kSample, "--out", out_, "--compression", compression, "--force"});
    ASSERT_EQ(output.exit_code, 0) << output.err;
    EXPECT_NE(output.out.find("12 frames, 12 with depth"), std::string::npos) << output.out;
    const auto expected = all_frames(kSample), replayed = all_frames("replay://" + out_);
    ASSERT_EQ(replayed.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(replayed[i].stamp_ns, expected[i].stamp_ns);
      EXPECT_EQ(replayed[i].sequence, i);
      EXPECT_EQ(replayed[i].gray.pixels, expected[i].gray.pixels);
      EXPECT_EQ(replayed[i].depth.pixels, expected[i].depth.pixels);
    }
  }
  const auto source = open_frame_source(out_);
  ASSERT_TRUE(source.is_ok() && (*source)->info().camera.has_value());
  EXPECT_EQ((*source)->info().camera->color.fx, sample_camera(160, 120).color.fx);
}

TEST_F(RecordTest, ColorAndJpeg) {
  const std::string first = folder_ / "first";
  ASSERT_EQ(run_record({"--source", kSample, "--out", first}).exit_code, 0);
  ASSERT_EQ(run_record({"--source", first, "--out", out_, "--color", "--jpeg", "--quality", "98"}).exit_code, 0);
  const auto expected = all_frames(first, true), replayed = all_frames(out_, true);
  ASSERT_EQ(replayed.size(), 12U);
  EXPECT_EQ(replayed[5].depth.pixels, expected[5].depth.pixels);
  ASSERT_EQ(replayed[5].color.pixels.size(), expected[5].color.pixels.size());
  double difference = 0;
  for (std::size_t i = 0; i < replayed[5].color.pixels.size(); ++i)
    difference += std::abs(replayed[5].color.pixels[i].g - expected[5].color.pixels[i].g);
  EXPECT_LT(difference / static_cast<double>(replayed[5].color.pixels.size()), 3);
  const CommandOutput without = run_record({"--source", kSample, "--out", folder_ / "third", "--color"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.err.find("has no colour"), std::string::npos) << without.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "third"));
}

TEST_F(RecordTest, LimitsEndIt) {
  EXPECT_NE(run_record({"--source", "sample://?rate_hz=0&width=64&height=48", "--out", out_, "--frames", "7"}).out.find("7 frames"),
            std::string::npos);
  const std::string timed = folder_ / "timed";
  ASSERT_EQ(run_record({"--source", "sample://?rate_hz=10&width=64&height=48", "--out", timed, "--seconds", "0.35"}).exit_code, 0);
  EXPECT_EQ(all_frames(timed).size(), 4U);
}

TEST_F(RecordTest, AnExistingFolderIsKept) {
  ASSERT_EQ(run_record({"--source", kSample, "--out", out_}).exit_code, 0);
  const CommandOutput again = run_record({"--source", kSample, "--out", out_});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("--force"), std::string::npos) << again.err;
  (void)folder_.write("walk/notes.txt", "mine");
  EXPECT_EQ(run_record({"--source", kSample, "--out", out_, "--force"}).exit_code, 2);
  EXPECT_EQ(all_frames(out_).size(), 12U) << "refused, so nothing was deleted";
  std::filesystem::remove(out_ + "/notes.txt");
  ASSERT_EQ(run_record({"--source", "sample://?rate_hz=0&frames=3&width=64&height=48", "--out", out_, "--force"}).exit_code, 0);
  EXPECT_EQ(all_frames(out_).size(), 3U);
  const CommandOutput itself = run_record({"--source", "replay://" + out_, "--out", out_, "--force"});
  EXPECT_EQ(itself.exit_code, 2);
  EXPECT_EQ(all_frames(out_).size(), 3U);
}

TEST_F(RecordTest, NothingStartsOnAFullDisk) {
  const CommandOutput output = run_record({"--source", kSample, "--out", out_, "--min-free", "99999999"});
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_NE(output.err.find("free on the disk"), std::string::npos) << output.err;
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(RecordTest, ACameraOfAnotherSizeIsRefused) {
  const std::string camera =
      folder_.write("camera.toml", "[color]\nwidth = 64\nheight = 48\nfx = 50\nfy = 50\ncx = 32\ncy = 24\n[depth]\nregistered = true\n");
  const CommandOutput output = run_record({"--source", kSample, "--out", out_, "--camera", camera});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_NE(output.err.find("64x48"), std::string::npos) << output.err;
}

/// A camera whose frames come when the test says so.
class LiveSource final : public FrameSource {
 public:
  explicit LiveSource(int num_frames) : num_frames_(num_frames) {
    info_.description = "a camera of the test";
    info_.stamp_clock = StampClock::kMonotonic;
  }
  [[nodiscard]] const FrameSourceInfo& info() const override { return info_; }
  [[nodiscard]] FrameSourceHealth health() const override {
    FrameSourceHealth health;
    health.acceleration = Eigen::Vector3d(0.1, -9.8, 0.2);  // level: up is -y of a camera
    health.frames_incomplete = 3;
    return health;
  }
  [[nodiscard]] Status next(FrameBuffer* frame, milliseconds timeout) override {
    if (index_ == num_frames_) {
      if (end_.code() == ErrorCode::kTimeout) std::this_thread::sleep_for(timeout);
      return end_;
    }
    ++index_;
    frame->sequence = static_cast<std::uint64_t>(index_ + (index_ > skip_after_ ? 5 : 0));
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    frame->stamp_ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
    frame->gray.resize(size_, size_);
    frame->depth.resize(size_, size_);
    for (std::size_t i = 0; i < frame->depth.pixels.size(); ++i)
      frame->depth.pixels[i] = static_cast<std::uint16_t>(i * 7919 + static_cast<std::size_t>(index_));
    return Status::ok();
  }

  FrameSourceInfo info_;
  int num_frames_, index_ = 0, skip_after_ = 1 << 20, size_ = 32;
  Status end_{ErrorCode::kEnd, "over"};
};

RecordingFolder make_folder(const std::string& path) {
  auto folder = RecordingFolder::create(path, {}, false);
  EXPECT_TRUE(folder.is_ok()) << folder.status().message();
  return std::move(folder).value();
}

TEST_F(RecordTest, LiveStampsAreMovedToTheEpoch) {
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

TEST_F(RecordTest, AFullQueueDropsCountsAndTells) {
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

TEST_F(RecordTest, ADiskThatFillsUpEndsItWhole) {
  LiveSource source(100);
  RecordingFolder folder = make_folder(out_);
  RecorderHooks hooks;
  int calls = 0;
  hooks.free_bytes = [&calls](const RecordingFolder&) -> Result<std::uint64_t> {
    return ++calls < 10 ? std::uint64_t{1} << 40 : std::uint64_t{1} << 20;
  };
  const RecordingSummary summary = record(&source, &folder, {}, {}, hooks);
  EXPECT_EQ(summary.end.code(), ErrorCode::kIo);
  EXPECT_NE(summary.end.message().find("1 MiB left"), std::string::npos) << summary.end.message();
  EXPECT_EQ(summary.frames, 10U) << "what was taken is written";
  EXPECT_EQ(all_frames(out_).size(), 10U);
}

TEST_F(RecordTest, AWriteThatFailsEndsItWhole) {
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

TEST_F(RecordTest, AnInterruptionIsNoFailure) {
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

TEST_F(RecordTest, ACameraThatGoesAwayOrIsSilentIsToldSo) {
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
