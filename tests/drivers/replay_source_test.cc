// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <filesystem>

#include "drivers/sources.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

using std::chrono::milliseconds;

std::unique_ptr<FrameSource> open_replay(const std::string& url) {
  auto source = open_frame_source(url);
  EXPECT_TRUE(source.is_ok()) << source.status().message();
  return source ? std::move(source).value() : nullptr;
}

std::vector<std::uint64_t> all_sequences(FrameSource* source) {
  std::vector<std::uint64_t> sequences;
  FrameBuffer frame;
  while (source->next(&frame, milliseconds(0))) sequences.push_back(frame.sequence);
  return sequences;
}

TEST(ReplaySource, DeliversEveryFrameOnce) {
  const TestFolder folder;
  write_7scenes(folder, 4);
  const auto source = open_replay("replay://" + folder.path());
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->info().color_width, 32);
  EXPECT_EQ(source->info().color_height, 24);
  EXPECT_EQ(source->info().depth_width, 32);
  EXPECT_EQ(source->info().num_frames, 4U);
  EXPECT_FALSE(source->info().camera);
  FrameBuffer frame;
  for (std::uint64_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(source->next(&frame, milliseconds(0)).is_ok());
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.stamp_ns, std::llround(static_cast<double>(i) * 1e9 / 30));
    EXPECT_EQ(frame.gray.pixels.size(), 32U * 24U);
    EXPECT_EQ(frame.depth.pixels, ramp_depth(32, 24, static_cast<int>(i)).pixels);
  }
  EXPECT_EQ(source->next(&frame, milliseconds(0)).code(), ErrorCode::kEnd);
  EXPECT_EQ(source->next(&frame, milliseconds(0)).code(), ErrorCode::kEnd);
}

TEST(ReplaySource, SelectionKeepsIndexInTheRecording) {
  const TestFolder folder;
  write_7scenes(folder, 8);
  const auto source = open_replay(folder.path() + "?frames=1:7:2,-1&exclude=3&rate_hz=10");
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->info().num_frames, 3U);
  FrameBuffer frame;
  ASSERT_TRUE(source->next(&frame, milliseconds(0)).is_ok());
  EXPECT_EQ(frame.sequence, 1U);
  EXPECT_EQ(frame.stamp_ns, 100'000'000);
  EXPECT_EQ(all_sequences(source.get()), (std::vector<std::uint64_t>{5, 7}));
}

TEST(ReplaySource, LoopGoesOnInTimeAndNumber) {
  const TestFolder folder;
  write_7scenes(folder, 3);
  const auto source = open_replay("replay://" + folder.path() + "?loop=1&frames=0,2&rate_hz=10");
  ASSERT_NE(source, nullptr);
  FrameBuffer frame;
  for (std::uint64_t round = 0; round < 3; ++round) {
    for (const std::uint64_t index : {0U, 2U}) {
      ASSERT_TRUE(source->next(&frame, milliseconds(0)).is_ok());
      EXPECT_EQ(frame.sequence, index + 3 * round);
      EXPECT_EQ(frame.stamp_ns, static_cast<std::int64_t>(index + 3 * round) * 100'000'000);
    }
  }
}

TEST(ReplaySource, BrokenFrameIsReportedAndPassed) {
  const TestFolder folder;
  write_7scenes(folder, 5);
  folder.write("frame-000000.color.jpg", "");
  folder.write("frame-000001.depth.png", "text");
  ASSERT_TRUE(write_jpeg(folder / "frame-000002.color.jpg", smooth_color(16, 12)));
  std::filesystem::remove(folder / "frame-000003.depth.png");
  const auto source = open_replay("replay://" + folder.path());
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->info().color_width, 16 * 2) << "the first readable image counts";
  std::filesystem::remove(folder / "frame-000004.color.jpg");
  FrameBuffer frame;
  for (const char* part :
       {"frame-000000.color.jpg: the file is empty", "frame-000001.depth.png: neither", "16x12 pixels, the recording has 32x24"}) {
    const Status status = source->next(&frame, milliseconds(0));
    EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
    EXPECT_NE(status.message().find(part), std::string::npos) << status.message();
  }
  ASSERT_TRUE(source->next(&frame, milliseconds(0)).is_ok());
  EXPECT_EQ(frame.sequence, 3U);
  EXPECT_TRUE(frame.view().depth.empty());
  EXPECT_EQ(source->next(&frame, milliseconds(0)).code(), ErrorCode::kCorrupt) << "file removed";
  EXPECT_EQ(source->next(&frame, milliseconds(0)).code(), ErrorCode::kEnd);
}

TEST(ReplaySource, FolderThatGoesAwayIsUnavailable) {
  const TestFolder folder;
  const std::string path = folder / "sub";
  std::filesystem::create_directory(path);
  ASSERT_TRUE(write_jpeg(path + "/frame-000000.color.jpg", smooth_color(16, 12)));
  const auto source = open_replay(path);
  ASSERT_NE(source, nullptr);
  std::filesystem::remove_all(path);
  FrameBuffer frame;
  const Status status = source->next(&frame, milliseconds(0));
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable) << status.message();
  EXPECT_NE(status.message().find("gone"), std::string::npos);
}

TEST(ReplaySource, PathsRelativeAndWithSpaces) {
  const TestFolder folder;
  const std::string path = folder / "my data 100%";
  std::filesystem::create_directory(path);
  ASSERT_TRUE(write_jpeg(path + "/frame-000000.color.jpg", smooth_color(16, 12)));
  for (const std::string& url : {"replay://" + folder.path() + "/my%20data%20100%25", "replay://" + path, path,
                                 std::filesystem::relative(path).string(), "replay://" + std::filesystem::relative(path).string()}) {
    EXPECT_NE(open_replay(url), nullptr) << url;
  }
}

TEST(ReplaySource, SpeedOfTheRecordingWaitsAndHonoursTheTimeout) {
  const TestFolder folder;
  write_7scenes(folder, 3);
  const auto source = open_replay("replay://" + folder.path() + "?speed=1&rate_hz=20");
  ASSERT_NE(source, nullptr);
  FrameBuffer frame;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(source->next(&frame, milliseconds(0)).is_ok()) << "the first frame is due at once";
  int timeouts = 0;
  Status status;
  while ((status = source->next(&frame, milliseconds(1))).code() != ErrorCode::kEnd) {
    if (status.code() == ErrorCode::kTimeout) ++timeouts;
  }
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(95)) << "two intervals of 50 ms";
  EXPECT_GE(timeouts, 1);
  EXPECT_EQ(frame.sequence, 2U);
}

TEST(ReplaySource, CameraFileOfTheRecording) {
  const TestFolder folder;
  write_7scenes(folder, 1);
  std::filesystem::copy_file(source_folder() / "config/cameras/kinect-v1.toml", folder / "camera.toml");
  const auto source = open_replay(folder.path());
  ASSERT_NE(source, nullptr);
  ASSERT_TRUE(source->info().camera);
  EXPECT_EQ(source->info().camera->name, "kinect-v1");
  folder.write("camera.toml", "[color]\n");
  EXPECT_NE(open_frame_source(folder.path()).status().message().find("camera.toml:1"), std::string::npos);
}

TEST(ReplaySource, ColorWhereItIsWanted) {
  const TestFolder folder;
  ColorImage red{std::vector<std::uint8_t>(3 * 16 * 12, 0), 16, 12};
  for (std::size_t i = 0; i < red.pixels.size(); i += 3) red.pixels[i] = 200;
  ASSERT_TRUE(write_png(folder / "frame-000000.color.png", red));
  for (const bool wants_color : {false, true}) {
    auto source = open_frame_source(folder.path(), {wants_color});
    ASSERT_TRUE(source.is_ok()) << source.status().message();
    FrameBuffer frame;
    ASSERT_TRUE((*source)->next(&frame, milliseconds(0)).is_ok());
    ASSERT_EQ(frame.color.pixels.size(), wants_color ? 16U * 12U : 0U);
    if (wants_color) EXPECT_EQ(frame.color.at(15, 11).r, 200);
    if (wants_color) EXPECT_EQ(frame.color.at(15, 11).b, 0);
  }
}

TEST(ReplaySource, BadUrls) {
  const TestFolder folder;
  write_7scenes(folder, 2);
  const std::string url = "replay://" + folder.path();
  const struct {
    std::string url;
    const char* part;
  } cases[] = {
      {url + "?sped=1", "knows speed, loop, frames, exclude, rate_hz"},
      {url + "?speed=-1", "speed=-1"},
      {url + "?loop=yes", "loop=yes"},
      {url + "?frames=a:b", "'a'"},
      {url + "?frames=5:", "leaves none of 2"},
      {url + "/none", "no such folder"},
      {"replay://", "no folder"},
      {"", "no folder"},
  };
  for (const auto& one : cases) {
    const auto source = open_frame_source(one.url);
    ASSERT_FALSE(source.is_ok()) << one.url;
    EXPECT_NE(source.status().message().find(one.part), std::string::npos) << source.status().message();
  }
}

TEST(ReplaySource, NoReadableImageAtAll) {
  const TestFolder folder;
  folder.write("frame-000000.color.jpg", "x");
  const auto source = open_frame_source(folder.path());
  EXPECT_EQ(source.status().code(), ErrorCode::kCorrupt);
  EXPECT_NE(source.status().message().find("frame-000000.color.jpg"), std::string::npos);
}

}  // namespace
}  // namespace camloc
