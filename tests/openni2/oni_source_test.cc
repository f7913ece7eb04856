// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// oni:// on recordings that were written byte by byte, whole and broken.
#include "drivers/openni2/oni_source.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <random>

#include "core/base/unique_fd.h"
#include "core/io/image_writer.h"
#include "drivers/sources.h"
#include "tests/drivers/test_folder.h"
#include "tests/openni2/oni_writer.h"

namespace camloc {
namespace {

using std::chrono::milliseconds;

Result<std::unique_ptr<FrameSource>> open_bytes(const TestFolder& folder, const std::string& bytes, const std::string& options = "",
                                                bool wants_color = false) {
  return open_frame_source("oni://" + folder.write("recording.oni", bytes) + options, {wants_color});
}

/// The same in memory, for thousands of them.
Result<std::unique_ptr<FrameSource>> open_in_memory(const std::string& bytes) {
  const UniqueFd file(::memfd_create("recording.oni", MFD_CLOEXEC));
  EXPECT_EQ(::pwrite(file.get(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  return open_frame_source("oni:///proc/self/fd/" + std::to_string(file.get()));
}

/// Plays to the end; frames that are broken count.
struct Played {
  std::vector<FrameBuffer> frames;
  int num_corrupt = 0;
};
Played play(FrameSource* source, std::size_t at_most = 1000) {
  Played played;
  FrameBuffer frame;
  while (played.frames.size() < at_most) {
    const Status status = source->next(&frame, milliseconds(5000));
    if (status) played.frames.push_back(frame);
    if (status.code() == ErrorCode::kCorrupt) ++played.num_corrupt;
    if (!status && status.code() != ErrorCode::kCorrupt) {
      EXPECT_EQ(status.code(), ErrorCode::kEnd) << status.message();
      break;
    }
  }
  return played;
}

TEST(OniSource, PlaysAllFramesWithTheirStampsAndEnds) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(5).end().bytes());
  ASSERT_TRUE(source) << source.status().message();
  EXPECT_EQ((*source)->info().num_frames, 5U);
  EXPECT_EQ((*source)->info().stamp_clock, StampClock::kRecorded);
  EXPECT_FALSE((*source)->info().camera.has_value());
  const Played played = play(source->get());
  ASSERT_EQ(played.frames.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const FrameBuffer& frame = played.frames[i];
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.stamp_ns, static_cast<std::int64_t>(i) * 33'000'000);
    ASSERT_EQ(frame.gray.width, 4);
    ASSERT_EQ(frame.depth.height, 2);
    EXPECT_TRUE(frame.color.pixels.empty());
    for (std::size_t p = 0; p < 8; ++p) EXPECT_EQ(frame.depth.pixels[p], 1000 + 10 * i + p);
  }
  FrameBuffer frame;
  EXPECT_EQ((*source)->next(&frame, milliseconds(0)).code(), ErrorCode::kEnd);
}

TEST(OniSource, GivesColourWhenAsked) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(2).end().bytes(), "", true);
  ASSERT_TRUE(source);
  const Played played = play(source->get());
  ASSERT_EQ(played.frames.size(), 2U);
  for (int p = 0; p < 8; ++p) {
    const Bgr pixel = played.frames[1].color.pixels[static_cast<std::size_t>(p)];
    EXPECT_EQ(pixel.r, 17 + 9 * p);
    EXPECT_EQ(pixel.g, 20 + 9 * p);
    EXPECT_EQ(pixel.b, 23 + 9 * p);
    EXPECT_NEAR(played.frames[1].gray.pixels[static_cast<std::size_t>(p)], 0.299 * pixel.r + 0.587 * pixel.g + 0.114 * pixel.b, 1);
  }
}

TEST(OniSource, ReadsEveryColourFormat) {
  const TestFolder folder;
  for (const int format : {200, 201, 202, 205}) {
    auto source = open_bytes(folder, small_recording(3, format).end().bytes(), "", true);
    ASSERT_TRUE(source) << format;
    EXPECT_EQ(play(source->get()).frames.size(), 3U) << format;
  }
  auto source = open_bytes(folder, small_recording(3, 102).end().bytes());
  ASSERT_FALSE(source);
  EXPECT_EQ(source.status().code(), ErrorCode::kUnsupported);
}

TEST(OniSource, KnowsTheDepthUnitAndTheCameraOfRegisteredDepth) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(3, 200, 101).end().bytes(), "?registered=1");
  ASSERT_TRUE(source);
  ASSERT_TRUE((*source)->info().camera.has_value());
  const RgbdCamera& camera = *(*source)->info().camera;
  EXPECT_DOUBLE_EQ(camera.depth_unit_m, 1e-4);
  EXPECT_NEAR(camera.color.fx, 4 / (2 * std::tan(0.5)), 1e-9);
  EXPECT_NEAR(camera.color.fy, 2 / (2 * std::tan(0.4)), 1e-9);
  EXPECT_DOUBLE_EQ(camera.color.cx, 1.5);
  EXPECT_TRUE(camera.is_depth_registered);
}

TEST(OniSource, UndoesMirroring) {
  const TestFolder folder;
  OniWriter writer;
  writer.node(1, "Depth", 2, "NONE").mode(1, 2, 1).number(1, "xnMirror", 1);
  writer.node(2, "Image", 3, "NONE").mode(2, 2, 1).number(2, "oniPixelFormat", 202).number(2, "xnMirror", 1);
  writer.frame(2, 0, 1, std::string("\x0A\x14")).frame(1, 0, 1, std::string("\x01\x00\x02\x00", 4)).end();
  auto source = open_bytes(folder, writer.bytes());
  ASSERT_TRUE(source);
  const Played played = play(source->get());
  ASSERT_EQ(played.frames.size(), 1U);
  EXPECT_EQ(played.frames[0].gray.pixels, (std::vector<std::uint8_t>{20, 10}));
  EXPECT_EQ(played.frames[0].depth.pixels, (std::vector<std::uint16_t>{2, 1}));
}

TEST(OniSource, ReadsFilesOfOpenNi1) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(4, 200, 100, 0, 6).end().bytes());
  ASSERT_TRUE(source) << source.status().message();
  EXPECT_EQ(play(source->get()).frames.size(), 4U);
}

TEST(OniSource, LoopsAndSelects) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(4).end().bytes(), "?loop=1&frames=::2");
  ASSERT_TRUE(source);
  const Played played = play(source->get(), 6);
  ASSERT_EQ(played.frames.size(), 6U);
  const std::int64_t length_ns = 4 * 33'000'000;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(played.frames[i].sequence, i / 2 * 4 + i % 2 * 2);
    EXPECT_EQ(played.frames[i].stamp_ns, static_cast<std::int64_t>(i / 2) * length_ns + static_cast<std::int64_t>(i % 2) * 66'000'000);
  }
}

TEST(OniSource, PlaysAtRecordedSpeed) {
  const TestFolder folder;
  auto source = open_bytes(folder, small_recording(5).end().bytes(), "?speed=2");
  ASSERT_TRUE(source);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(play(source->get()).frames.size(), 5U);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(66));
}

TEST(OniSource, ColourWithoutDepthInTimeComesWithoutDepth) {
  const TestFolder folder;
  OniWriter writer = small_recording(2);
  writer.frame(2, 200'000, 3, std::string(24, 'x')).end();
  auto source = open_bytes(folder, writer.bytes());
  ASSERT_TRUE(source);
  const Played played = play(source->get());
  ASSERT_EQ(played.frames.size(), 3U);
  EXPECT_EQ(played.frames[1].depth.width, 4);
  EXPECT_TRUE(played.frames[2].depth.pixels.empty());
}

TEST(OniSource, BrokenFramesAreNamedAndPassedOver) {
  const TestFolder folder;
  OniWriter writer = small_recording(2);
  writer.frame(2, 66'000, 3, "short").frame(1, 66'000, 3, std::string(16, 'x'));
  writer.mode(2, 8, 8).frame(2, 99'000, 4, std::string(192, 'x')).mode(2, 4, 2).frame(2, 133'000, 5, std::string(24, 'x')).end();
  auto source = open_bytes(folder, writer.bytes());
  ASSERT_TRUE(source);
  const Played played = play(source->get());
  EXPECT_EQ(played.frames.size(), 3U);
  EXPECT_EQ(played.num_corrupt, 2);
}

TEST(OniSource, RefusesWhatItCannotUse) {
  const TestFolder folder;
  const auto code_of = [&folder](const std::string& bytes, const std::string& options = "") {
    return open_bytes(folder, bytes, options).status().code();
  };
  EXPECT_EQ(open_frame_source("oni:///nowhere.oni").status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(open_frame_source("oni://" + folder.path()).status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(open_frame_source("oni://").status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(open_frame_source("oni:///dev/zero").status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(""), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(std::string(100, '\0')), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(OniWriter().end().bytes()), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(OniWriter(2).end().bytes()), ErrorCode::kUnsupported);
  EXPECT_EQ(code_of(OniWriter().node(1, "Image", 3, "Im8z").bytes()), ErrorCode::kUnsupported);
  EXPECT_EQ(code_of(OniWriter().node(1, "Depth", 2, "NONE").mode(1, 1, 1).frame(1, 0, 1, "xx").end().bytes()), ErrorCode::kUnsupported);
  EXPECT_EQ(code_of(OniWriter().node(1, "Image", 3, "NONE").frame(1, 0, 1, "xx").end().bytes()), ErrorCode::kCorrupt);  // no size
  EXPECT_EQ(code_of(small_recording(2).end().bytes(), "?speed=-1"), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(small_recording(2).end().bytes(), "?loop=2"), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(small_recording(2).end().bytes(), "?rate=2"), ErrorCode::kInvalid);
  EXPECT_EQ(code_of(small_recording(2).end().bytes(), "?frames=5:"), ErrorCode::kInvalid);
}

TEST(OniSource, ReadsWhatIsWholeOfAFileThatWasCutAnywhere) {
  const std::string whole = small_recording(4).end().bytes();
  std::size_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    auto source = open_in_memory(whole.substr(0, size));
    if (!source) {
      EXPECT_EQ(most, 0U) << "refused after " << size << " bytes";
      continue;
    }
    const Played played = play(source->get());
    EXPECT_GE(played.frames.size(), most);
    EXPECT_EQ(played.num_corrupt, 0);
    EXPECT_EQ((*source)->info().description.find("cut off") == std::string::npos, size == whole.size());
    most = played.frames.size();
  }
  EXPECT_EQ(most, 4U);
}

TEST(OniSource, SurvivesChangedBytes) {
  const std::string whole = small_recording(4).end().bytes();
  std::mt19937 random(5);
  int num_open = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k <= i % 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    auto source = open_in_memory(bytes);
    if (!source) {
      EXPECT_EQ(source.status().message().find('\n'), std::string::npos);
      continue;
    }
    ++num_open;
    EXPECT_LE(play(source->get()).frames.size(), 4U);
  }
  EXPECT_GT(num_open, 100);
}

TEST(OniSource, ReadsJpegThatTheDeviceDelivered) {
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "image.jpg", smooth_color(32, 24)));
  const std::vector<std::uint8_t> jpeg = bytes_of(folder / "image.jpg");
  OniWriter writer;
  writer.node(2, "Image", 3, "NONE")
      .mode(2, 32, 24)
      .number(2, "oniPixelFormat", 204)
      .frame(2, 0, 1, std::string(jpeg.begin(), jpeg.end()))
      .end();
  auto source = open_bytes(folder, writer.bytes());
  ASSERT_TRUE(source) << source.status().message();
  EXPECT_EQ(play(source->get()).frames.size(), 1U);
}

TEST(OniSource, ReadsJpegColour) {
  const TestFolder folder;
  const ColorImage image = smooth_color(32, 24);
  ASSERT_TRUE(write_jpeg(folder / "image.jpg", image));
  const std::vector<std::uint8_t> jpeg = bytes_of(folder / "image.jpg");
  OniWriter writer;
  writer.node(2, "Image", 3, "JPEG").mode(2, 32, 24).number(2, "oniPixelFormat", 200).frame(2, 0, 1, std::string(jpeg.begin(), jpeg.end()));
  writer.frame(2, 33'000, 2, std::string(jpeg.begin(), jpeg.begin() + 300)).end();
  auto source = open_bytes(folder, writer.bytes(), "", true);
  ASSERT_TRUE(source) << source.status().message();
  const Played played = play(source->get());
  ASSERT_EQ(played.frames.size(), 1U);
  EXPECT_EQ(played.num_corrupt, 1);
  for (std::size_t i = 0; i < played.frames[0].color.pixels.size(); ++i)
    EXPECT_NEAR(played.frames[0].color.pixels[i].g, image.pixels[3 * i + 1], 12);
}

}  // namespace
}  // namespace camloc
