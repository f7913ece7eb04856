// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// v4l2:// from URL to pixels on a device in process: pairing, stamps, faults, restart, reset.
#include "drivers/v4l2/v4l2_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/drivers/fake_v4l2.h"
#include "tests/drivers/test_folder.h"
#include "tests/geometry/allocation_counter.h"

namespace camloc {
namespace {

using std::chrono::milliseconds;
using testing::FakeNode;
using testing::FakeV4l2;

constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr const char* kColor = "/dev/video0";
constexpr const char* kDepth = "/dev/video2";

/// Z16 whose every pixel is 1000 plus the number of the exposure.
std::size_t paint_depth(std::uint64_t number, unsigned /*plane*/, std::span<std::uint8_t> bytes) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    bytes[i] = static_cast<std::uint8_t>(1000 + number);
    bytes[i + 1] = static_cast<std::uint8_t>((1000 + number) >> 8);
  }
  return bytes.size();
}

class V4l2Source : public ::testing::Test {
 protected:
  V4l2Source() {
    color_.card = "Colour";
    color_.formats = {{V4L2_PIX_FMT_YUYV, {{640, 480, {30}}, {160, 120, {30, 60}}}}};
    depth_.card = "Depth";
    depth_.formats = {{V4L2_PIX_FMT_Z16, {{640, 480, {30}}, {160, 120, {30, 90}}}}};
    depth_.paint = paint_depth;
  }
  ~V4l2Source() override {
    source_.reset();
    EXPECT_EQ(io_->num_open(), 0);
    EXPECT_EQ(io_->num_mapped(), 0U);
  }
  Status open(const std::string& text, const FrameSourceOptions& options = {}) {
    const Result<SourceUrl> url = parse_source_url(text);
    if (!url) return url.status();
    Result<std::unique_ptr<FrameSource>> source = open_v4l2_source_on(io_, folders_, *url, options);
    if (!source) return source.status();
    source_ = std::move(source).value();
    return Status::ok();
  }
  ErrorCode next(int timeout_ms = 1000) {
    const Status status = source_->next(&frame_, milliseconds(timeout_ms));
    problem_ = status.message();
    return status.code();
  }

  TestFolder folder_;
  SystemFolders folders_{folder_.path()};
  std::shared_ptr<FakeV4l2> io_ = std::make_shared<FakeV4l2>();
  FakeNode& color_ = io_->add(kColor);
  FakeNode& depth_ = io_->add(kDepth);
  std::unique_ptr<FrameSource> source_;
  FrameBuffer frame_;
  std::string problem_;
};

TEST_F(V4l2Source, PairsOfOneExposure) {
  depth_.phase_ns = 5 * kNsPerMs;
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30&format=YUYV&depth_format=Z16"));
  EXPECT_EQ(source_->info().color_width, 160);
  EXPECT_EQ(source_->info().depth_height, 120) << "depth is wished to be of the image's size";
  EXPECT_EQ(source_->info().stamp_clock, StampClock::kMonotonic);
  EXPECT_EQ(source_->info().description,
            "/dev/video0 'Colour' YUYV 160x120 at 30 Hz, depth /dev/video2 'Depth' Z16 160x120 at 30 Hz; stamps of the start of exposure");
  const std::int64_t start_ns = io_->monotonic_ns();
  for (std::uint64_t i = 0; i < 100; ++i) {
    ASSERT_EQ(next(), ErrorCode::kOk) << problem_;
    EXPECT_EQ(frame_.sequence, i + 1);
    EXPECT_EQ(frame_.gray.at(159, 119), i);
    EXPECT_EQ(frame_.depth.at(159, 119), 1000 + i);
    EXPECT_NEAR(static_cast<double>(frame_.stamp_ns - start_ns), static_cast<double>(i) * 1e9 / 30, 2000) << "microseconds are cut off";
  }
  EXPECT_TRUE(frame_.color.pixels.empty());
  EXPECT_EQ(source_->health().packets_lost + source_->health().frames_incomplete + source_->health().frames_unpaired, 0U);
}

TEST_F(V4l2Source, NearestStampsAreAPairAndTheRestIsCounted) {
  color_.phase_ns = 0;
  depth_.phase_ns = 25 * kNsPerMs;  // nearest to the colour frame 8.3 ms later
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30"));
  for (std::uint64_t i = 0; i < 20; ++i) {
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_EQ(frame_.gray.at(0, 0), i + 1);
    EXPECT_EQ(frame_.depth.at(0, 0), 1000 + i);
  }
  EXPECT_EQ(source_->health().frames_unpaired, 1U);
}

TEST_F(V4l2Source, ColorTwiceAsFastAsDepth) {
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=60&depth_rate_hz=30"));
  for (std::uint64_t i = 0; i < 20; ++i) {
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_EQ(frame_.gray.at(0, 0), 2 * i);
    EXPECT_EQ(frame_.depth.at(0, 0), 1000 + i);
  }
  EXPECT_EQ(source_->health().frames_unpaired, 19U);
}

TEST_F(V4l2Source, NothingIsAllocatedPerFrame) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "a sanitizer owns the allocator";
  depth_.phase_ns = 5 * kNsPerMs;
  for (const std::uint32_t fourcc : {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_Y10BPACK}) {
    color_.formats = {{fourcc, {{160, 120, {30}}}}};
    ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120", {.wants_color = true}));
    for (int i = 0; i < 5; ++i) ASSERT_EQ(next(), ErrorCode::kOk);
    const std::uint64_t before = testing::num_allocations();
    int num_frames = 0;
    for (int i = 0; i < 100; ++i) num_frames += source_->next(&frame_, milliseconds(100)).is_ok();
    for (int i = 0; i < 100; ++i) num_frames += source_->next(&frame_, milliseconds(1)).is_ok();  // most of them in vain
    EXPECT_EQ(testing::num_allocations(), before);
    EXPECT_GT(num_frames, 100);
    source_.reset();
  }
}

TEST_F(V4l2Source, DepthAlone) {
  for (const char* url : {"v4l2://?depth=/dev/video2", "v4l2:///dev/video2", "v4l2:///dev/video2?format=Z16"}) {
    ASSERT_TRUE(open(url)) << url;
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_TRUE(frame_.gray.view().empty());
    EXPECT_EQ(frame_.depth.width, 640);
    EXPECT_EQ(source_->info().color_width, 0);
    source_.reset();
  }
}

TEST_F(V4l2Source, InfraredIsTheImage) {
  color_.formats = {{V4L2_PIX_FMT_Y16, {{64, 48, {30}}}}};
  color_.paint = [](std::uint64_t, unsigned, std::span<std::uint8_t> bytes) {
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) bytes[i] = 0x84, bytes[i + 1] = 0x02;  // 644
    return bytes.size();
  };
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&gray_bits=10", {.wants_color = true}));
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_EQ(frame_.gray.at(63, 47), 644 >> 2);
  EXPECT_EQ(frame_.depth.width, 640) << "of a size of its own";
  EXPECT_TRUE(frame_.color.pixels.empty());
  source_.reset();
  ASSERT_TRUE(open("v4l2:///dev/video0"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_EQ(frame_.gray.at(0, 0), 2) << "16 bits";
  EXPECT_TRUE(frame_.depth.view().empty());
}

TEST_F(V4l2Source, Y16AsDepth) {
  depth_.formats = {{V4L2_PIX_FMT_Y16, {{160, 120, {30}}}}};
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_EQ(frame_.depth.at(3, 3), 1000);
}

TEST_F(V4l2Source, ColorOnRequest) {
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120", {.wants_color = true}));
  color_.paint = [](std::uint64_t, unsigned, std::span<std::uint8_t> bytes) {
    for (std::size_t i = 0; i + 3 < bytes.size(); i += 4)
      bytes[i] = bytes[i + 2] = 81, bytes[i + 1] = 90, bytes[i + 3] = 240;  // red, BT.601
    return bytes.size();
  };
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_EQ(frame_.gray.at(0, 0), 81);
  EXPECT_NEAR(frame_.color.at(159, 119).r, 255, 2);
  EXPECT_NEAR(frame_.color.at(159, 119).b, 0, 2);
}

TEST_F(V4l2Source, PaddedRowsAndMultiplanarNodes) {
  color_.padding_bytes = 32;
  color_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  color_.formats = {{V4L2_PIX_FMT_NV12M, {{64, 48, {30}}}}};
  color_.paint = [](std::uint64_t, unsigned plane, std::span<std::uint8_t> bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = plane == 1 ? 128 : i % 96 < 64 ? static_cast<std::uint8_t>(100 + i / 96) : 255;
    return bytes.size();
  };
  ASSERT_TRUE(open("v4l2:///dev/video0", {.wants_color = true}));
  ASSERT_EQ(next(), ErrorCode::kOk) << problem_;
  for (int y = 0; y < 48; ++y) {
    EXPECT_EQ(frame_.gray.at(0, y), 100 + y);
    EXPECT_EQ(frame_.gray.at(63, y), 100 + y);
    EXPECT_EQ(frame_.color.at(63, y).r, frame_.color.at(0, y).b);
  }
}

TEST_F(V4l2Source, StampsByTheirClock) {
  color_.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  EXPECT_NE(source_->info().description.find("end of the frame"), std::string::npos) << source_->info().description;
  const std::int64_t start_ns = io_->monotonic_ns();
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_NEAR(static_cast<double>(frame_.stamp_ns - start_ns), -1e9 / 30, 2000);

  for (const std::uint32_t flags : {V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN, V4L2_BUF_FLAG_TIMESTAMP_COPY}) {
    color_.stamp_flags = flags;
    color_.faults.stamp = timeval{1'700'000'000, 0};  // seconds since the epoch
    source_.reset();
    ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120&stamp_offset_ms=-2.5"));
    EXPECT_NE(source_->info().description.find("warning: the driver names no clock"), std::string::npos) << source_->info().description;
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_NEAR(static_cast<double>(frame_.stamp_ns - io_->monotonic_ns()), -1e9 / 30 - 2.5e6, 1);
  }
}

TEST_F(V4l2Source, StampsThatCannotBeTrueAreNotBelieved) {
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  std::int64_t last_ns = 0;
  for (const timeval stamp :
       {timeval{0, 0}, {1'700'000'000, 5}, {-1, 0}, {50, 9'999'999}, {50, -5}, {9'000'000'000'000'000'000, 0}, {1, 1}}) {
    color_.faults.stamp = stamp;
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_NEAR(static_cast<double>(frame_.stamp_ns), static_cast<double>(io_->monotonic_ns()) - 1e9 / 30, 1);
    EXPECT_GT(frame_.stamp_ns, last_ns);
    last_ns = frame_.stamp_ns;
  }
  EXPECT_NE(source_->info().description.find("warning"), std::string::npos);
  const std::int64_t now_ns = io_->monotonic_ns();
  color_.faults.stamp = timeval{now_ns / 1'000'000'000, now_ns % 1'000'000'000 / 1000};  // stands still
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_GT(frame_.stamp_ns, last_ns);
    last_ns = frame_.stamp_ns;
  }
}

TEST_F(V4l2Source, DamagedFramesAreCorruptAndCounted) {
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  std::uint64_t num_broken = 0;
  const auto expect_one_broken = [&](FakeNode& node) {
    // Those already exposed are still fine; then the broken ones come, and then fine ones again.
    int num_turns = 0;
    while (next() == ErrorCode::kOk && ++num_turns < 10) {}
    EXPECT_EQ(next(), ErrorCode::kCorrupt);
    const std::string what = node.faults.bytesused
                                 ? "a frame of " + std::to_string(*node.faults.bytesused) + " bytes where there should be 38400"
                                 : "marked a frame";
    EXPECT_NE(problem_.find(what), std::string::npos) << problem_;
    node.faults.bytesused.reset();
    node.faults.buffer_flags = 0;
    while (source_->health().frames_incomplete == num_broken || next() == ErrorCode::kCorrupt) {}
    ASSERT_EQ(next(), ErrorCode::kOk);
    EXPECT_EQ(frame_.gray.at(0, 0) + 1000, frame_.depth.at(0, 0)) << "pairs again";
    EXPECT_GT(source_->health().frames_incomplete, num_broken);
    num_broken = source_->health().frames_incomplete;
  };
  for (FakeNode* node : {&color_, &depth_}) {
    node->faults.buffer_flags = V4L2_BUF_FLAG_ERROR;
    expect_one_broken(*node);
    for (const std::uint32_t bytes : {0U, 1U, 160U * 120 * 2 - 1, 160U * 120 * 2 + 1, 0xFFFFFFFFU}) {
      node->faults.bytesused = bytes;
      expect_one_broken(*node);
    }
  }
}

TEST_F(V4l2Source, GapsAreCounted) {
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  color_.faults.sequence_jump = 5;
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_EQ(frame_.sequence, 7U);
  EXPECT_EQ(source_->health().packets_lost, 5U);
  io_->advance_ns(1000 * kNsPerMs);  // nobody fetches: four buffers are full, the rest is lost
  const std::uint64_t before = frame_.sequence;
  for (int i = 0; i < 6; ++i) ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_GT(source_->health().packets_lost, 25U);
  EXPECT_EQ(frame_.sequence, before + 6 + source_->health().packets_lost - 5);
  color_.faults.sequence_jump = 0xFFFFFF00U;
  ASSERT_EQ(next(), ErrorCode::kOk);
  ASSERT_EQ(next(), ErrorCode::kOk);
  EXPECT_LT(source_->health().packets_lost, 100U) << "a counter that jumps back counts nothing";
}

TEST_F(V4l2Source, AStallIsATimeoutAndARestartMendsIt) {
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  depth_.faults.is_stalled = true;
  while (next(100) == ErrorCode::kOk) {}
  const std::int64_t before_ns = io_->monotonic_ns();
  EXPECT_EQ(next(100), ErrorCode::kTimeout) << problem_;
  EXPECT_NEAR(static_cast<double>(io_->monotonic_ns() - before_ns), 100e6, 2e6);
  depth_.faults.is_stalled = false;
  ASSERT_TRUE(source_->restart());
  EXPECT_EQ(depth_.num_starts, 2);
  EXPECT_EQ(color_.num_stops, 1);
  const std::int64_t restarted_ns = io_->monotonic_ns();
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(next(), ErrorCode::kOk) << problem_;
    EXPECT_EQ((frame_.gray.at(0, 0) + 1000) % 256, frame_.depth.at(0, 0) % 256);
    EXPECT_GE(frame_.stamp_ns, restarted_ns - kNsPerMs) << "nothing from before the restart";
  }
}

TEST_F(V4l2Source, AStallOfOneNodeThatEndsByItself) {
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30"));
  depth_.faults.is_stalled = true;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(next(100), ErrorCode::kTimeout);
  depth_.faults.is_stalled = false;
  ASSERT_EQ(next(200), ErrorCode::kOk) << problem_;
  EXPECT_EQ(frame_.gray.at(0, 0) + 1000, frame_.depth.at(0, 0));
  EXPECT_LE(source_->health().frames_unpaired, 5U);
}

TEST_F(V4l2Source, UnpluggedIsUnavailableAtOnce) {
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&width=160&height=120&rate_hz=30"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  depth_.faults.is_gone = true;
  const std::int64_t before_ns = io_->monotonic_ns();
  ErrorCode code = next();
  if (code == ErrorCode::kOk) code = next();
  EXPECT_EQ(code, ErrorCode::kUnavailable);
  EXPECT_NE(problem_.find("No such device"), std::string::npos) << problem_;
  EXPECT_LT(io_->monotonic_ns() - before_ns, 50 * kNsPerMs);
  EXPECT_EQ(source_->restart().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(next(), ErrorCode::kUnavailable);
}

TEST_F(V4l2Source, ErrorsOfPollDoNotSpin) {
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  ASSERT_EQ(next(), ErrorCode::kOk);
  color_.faults.has_poll_error = color_.faults.is_stalled = true;
  EXPECT_EQ(next(), ErrorCode::kUnavailable);
}

TEST_F(V4l2Source, BuffersThatTheDriverDoesNotHave) {
  for (const std::uint32_t index : {4U, 0xFFFFFFFFU}) {
    ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
    color_.faults.index = index;
    EXPECT_EQ(next(), ErrorCode::kUnavailable);
    EXPECT_NE(problem_.find("hands out buffers"), std::string::npos) << problem_;
    source_.reset();
    color_.faults.index.reset();
  }
}

TEST_F(V4l2Source, BufferLengthsAreChecked) {
  for (const std::uint32_t length : {0U, 1U, 160U * 120 * 2 - 1, 0xFFFFFFFFU}) {
    color_.faults.buffer_length = length;
    EXPECT_EQ(open("v4l2:///dev/video0?width=160&height=120").code(), ErrorCode::kCorrupt) << length;
  }
  color_.faults.buffer_length.reset();
  color_.faults.num_buffers = 1;
  EXPECT_EQ(open("v4l2:///dev/video0?width=160&height=120").code(), ErrorCode::kUnavailable);
  color_.faults.num_buffers = 32;
  EXPECT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  EXPECT_EQ(next(), ErrorCode::kOk);
}

TEST_F(V4l2Source, MjpegFramesOfARecording) {
  const ColorImage image = smooth_color(64, 48);
  ASSERT_TRUE(write_jpeg(folder_ / "a.jpg", image));
  const std::vector<std::uint8_t> jpeg = bytes_of(folder_ / "a.jpg");
  color_.formats = {{V4L2_PIX_FMT_MJPEG, {{64, 48, {30}}}}};
  bool is_cut = false;
  color_.paint = [&](std::uint64_t, unsigned, std::span<std::uint8_t> bytes) {
    std::memcpy(bytes.data(), jpeg.data(), jpeg.size());
    return is_cut ? jpeg.size() / 2 : jpeg.size();
  };
  ASSERT_TRUE(open("v4l2:///dev/video0", {.wants_color = true}));
  ASSERT_EQ(next(), ErrorCode::kOk) << problem_;
  EXPECT_NEAR(frame_.color.at(32, 24).r, image.pixels[3 * (24 * 64 + 32)], 12);
  is_cut = true;
  ErrorCode code = ErrorCode::kOk;
  for (int i = 0; i < 6 && code == ErrorCode::kOk; ++i) code = next();
  EXPECT_EQ(code, ErrorCode::kCorrupt);
  EXPECT_EQ(source_->health().frames_incomplete, 1U);
  is_cut = false;
  code = ErrorCode::kCorrupt;
  for (int i = 0; i < 6 && code != ErrorCode::kOk; ++i) code = next();
  EXPECT_EQ(code, ErrorCode::kOk);
}

TEST_F(V4l2Source, ControlsFromTheUrl) {
  color_.controls = {{0x980913, V4L2_CTRL_TYPE_INTEGER, 0, "Gain", 0, 255, {}}};
  depth_.controls = {{0x980914, V4L2_CTRL_TYPE_INTEGER, 0, "Laser Power", 0, 255, {}}};
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&control.gain=10&depth_control.laser_power=150"));
  EXPECT_EQ(color_.controls_set, (std::vector<std::pair<std::string, int>>{{"Gain", 10}}));
  EXPECT_EQ(depth_.controls_set, (std::vector<std::pair<std::string, int>>{{"Laser Power", 150}}));
  source_.reset();
  EXPECT_EQ(open("v4l2:///dev/video0?control.exposure=1").code(), ErrorCode::kInvalid);
}

TEST_F(V4l2Source, CameraFileAndDepthUnit) {
  EXPECT_EQ(open("v4l2:///dev/video0?depth_unit_m=0.0001").code(), ErrorCode::kInvalid);
  const std::string camera =
      folder_.write("camera.toml", "[color]\nwidth = 640\nheight = 480\nfx = 525.0\nfy = 525.0\ncx = 319.5\ncy = 239.5\n");
  ASSERT_TRUE(open("v4l2:///dev/video0?depth=/dev/video2&depth_unit_m=0.0001&camera=" + camera));
  ASSERT_TRUE(source_->info().camera);
  EXPECT_EQ(source_->info().camera->depth_unit_m, 0.0001);
  source_.reset();
  EXPECT_FALSE(open("v4l2:///dev/video0?camera=/nosuch.toml"));
}

TEST_F(V4l2Source, BadUrls) {
  for (const char* url : {"v4l2://", "v4l2:///dev/video0?width=0", "v4l2:///dev/video0?width=1.5", "v4l2:///dev/video0?rate_hz=x",
                          "v4l2:///dev/video0?format=H264", "v4l2:///dev/video0?speed=1", "v4l2:///dev/video0?gray_bits=7",
                          "v4l2:///dev/video0?depth=/dev/video0", "v4l2:///dev/video0?stamp_offset_ms=1e9"}) {
    const Status status = open(url);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << url << ": " << status.message();
    EXPECT_EQ(status.message().find('\n'), std::string::npos);
  }
  EXPECT_EQ(open("v4l2:///dev/video7").code(), ErrorCode::kUnavailable);
  EXPECT_EQ(open("v4l2://serial:ABC").code(), ErrorCode::kUnavailable);
  EXPECT_EQ(open("v4l2:///dev/video0?depth=/dev/video0").code(), ErrorCode::kInvalid);
}

TEST_F(V4l2Source, ResetOfTheUsbDevice) {
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  EXPECT_EQ(source_->reset_device().code(), ErrorCode::kUnsupported) << "not on USB";
  ASSERT_EQ(next(), ErrorCode::kOk) << "and still alive";
  source_.reset();

  folder_.write("sys/devices/usb1/idVendor", "8086\n");
  folder_.write("sys/devices/usb1/idProduct", "0ad2\n");
  folder_.write("sys/devices/usb1/busnum", "3\n");
  folder_.write("sys/devices/usb1/devnum", "14\n");
  folder_.write("sys/devices/usb1/serial", "S1\n");
  std::filesystem::create_directories(folder_ / "sys/devices/usb1/interface");
  std::filesystem::create_directories(folder_ / "sys/class/video4linux/video0");
  std::filesystem::create_symlink(folder_ / "sys/devices/usb1/interface", folder_ / "sys/class/video4linux/video0/device");
  ASSERT_TRUE(open("v4l2:///dev/video0?width=160&height=120"));
  EXPECT_EQ(source_->info().serial, "S1");
  EXPECT_EQ(source_->reset_device().code(), ErrorCode::kUnsupported) << "no right to open it";
  ASSERT_EQ(next(), ErrorCode::kOk);
  FakeNode& usb = io_->add(folders_.path("/dev") + "/bus/usb/003/014");
  EXPECT_TRUE(source_->reset_device());
  EXPECT_EQ(usb.num_resets, 1);
  EXPECT_EQ(io_->num_mapped(), 0U);
  EXPECT_EQ(next(), ErrorCode::kUnavailable);
  EXPECT_EQ(source_->restart().code(), ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace camloc
