// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A folder that replay:// reads at every moment, and that deletes nothing which it did not write.
#include "tools/recording/recording_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/io/sequence.h"
#include "tests/tools/command_runner.h"
#include "tests/tools/live_source.h"

namespace camloc::tools {
namespace {

FrameBuffer frame_of(std::uint8_t grey) {
  FrameBuffer frame;
  frame.gray.resize(16, 12);
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), grey);
  frame.depth.resize(16, 12);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{1000});
  return frame;
}

std::string text_in(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(RecordingFolderTest, AFrameIsNamedWhenItsImagesAreWhole) {
  const TemporaryFolder scratch;
  RecordingFolder folder = make_folder(scratch / "walk");
  EXPECT_FALSE(read_sequence(scratch / "walk").is_ok()) << "no frame yet";
  const auto bytes = folder.write_images(frame_of(77), 1'500'000'000);
  ASSERT_TRUE(bytes.is_ok()) << bytes.status().message();
  EXPECT_EQ(*bytes, std::filesystem::file_size(scratch / "walk/rgb/1.500000000.png") +
                        std::filesystem::file_size(scratch / "walk/depth/1.500000000.png"));
  ASSERT_TRUE(folder.append_frame(1'500'000'000, true).is_ok());
  const auto sequence = read_sequence(scratch / "walk");
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  ASSERT_EQ(sequence->frames.size(), 1U);
  EXPECT_EQ(sequence->frames[0].stamp_ns, 1'500'000'000);
  const auto frames = all_frames(scratch / "walk");
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].gray.pixels[0], 77);
  EXPECT_EQ(frames[0].depth.pixels[5], 1000);
  EXPECT_TRUE(folder.sync().is_ok());
}

TEST(RecordingFolderTest, AccelerationsHaveTheirFileOnlyWhereThereAreSome) {
  const TemporaryFolder scratch;
  RecordingFolder folder = make_folder(scratch / "walk");
  EXPECT_FALSE(std::filesystem::exists(scratch / "walk/accelerometer.txt"));
  ASSERT_TRUE(folder.append_acceleration(2'000'000'001, {0, -9.8, 0}).is_ok());
  EXPECT_NE(text_in(scratch / "walk/accelerometer.txt").find("\n2.000000001 "), std::string::npos);
}

TEST(RecordingFolderTest, OnlyWhatARecorderWroteIsDeleted) {
  const TemporaryFolder scratch;
  {
    RecordingFolder folder = make_folder(scratch / "walk");
    ASSERT_TRUE(folder.write_images(frame_of(1), 1).is_ok());
    ASSERT_TRUE(folder.append_frame(1, true).is_ok());
  }
  EXPECT_EQ(RecordingFolder::create(scratch / "walk", {}, false).status().code(), ErrorCode::kInvalid);
  static_cast<void>(scratch.write("walk/rgb/notes.txt", "mine"));
  const auto refused = RecordingFolder::create(scratch / "walk", {}, true);
  EXPECT_NE(refused.status().message().find("rgb/notes.txt"), std::string::npos) << refused.status().message();
  EXPECT_EQ(all_frames(scratch / "walk").size(), 1U);
  std::filesystem::remove(scratch / "walk/rgb/notes.txt");
  auto replaced = RecordingFolder::create(scratch / "walk", {}, true);
  ASSERT_TRUE(replaced.is_ok()) << replaced.status().message();
  EXPECT_FALSE(std::filesystem::exists(scratch / "walk/rgb/0.000000001.png"));
  replaced->discard();
  EXPECT_FALSE(std::filesystem::exists(scratch / "walk"));
}

TEST(RecordingFolderTest, StampsKeepTheirZerosAndSpaceIsAskedOfWhatExists) {
  EXPECT_EQ(stamp_text(1'000'000'007), "1.000000007");
  const auto here = free_bytes_at("/"), below = free_bytes_at("/no/such/folder");
  ASSERT_TRUE(here.is_ok() && below.is_ok());
  EXPECT_GT(*below, 0U);
}

}  // namespace
}  // namespace camloc::tools
