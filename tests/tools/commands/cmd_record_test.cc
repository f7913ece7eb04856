// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What `camloc record` writes is what replay:// reads, and nothing is written over.
#include <filesystem>

#include "drivers/sample_source.h"
#include "drivers/sources.h"
#include "tests/tools/command_runner.h"
#include "tests/tools/live_source.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

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

}  // namespace
}  // namespace camloc::tools
