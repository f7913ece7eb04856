// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is agreed on with honest devices, and what is said to those that offer something else or contradict themselves.
#include "drivers/v4l2/v4l2_negotiation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/fake_v4l2.h"

namespace camloc {
namespace {

using testing::FakeNode;
using testing::FakeV4l2;

constexpr const char* kPath = "/dev/video0";

class V4l2Negotiation : public ::testing::Test {
 protected:
  V4l2Negotiation() {
    node_.formats = {{V4L2_PIX_FMT_MJPEG, {{640, 480, {30}}, {1280, 720, {30, 15}}}},
                     {V4L2_PIX_FMT_YUYV, {{640, 480, {30, 15}}, {1280, 720, {10}}, {320, 240, {60, 30}}}},
                     {V4L2_PIX_FMT_Z16, {{640, 480, {30}}, {848, 480, {90, 30}}}},
                     {v4l2_fourcc('H', '2', '6', '4'), {{1920, 1080, {30}}}}};
  }
  Result<V4l2Agreement> negotiate(const V4l2Wish& wish) {
    const Result<V4l2Device> device = V4l2Device::open(io_, kPath);
    EXPECT_TRUE(device) << device.status().message();
    return device ? negotiate_v4l2(*device, wish) : device.status();
  }
  /// "YUYV 640x480 30"
  std::string agreed(const V4l2Wish& wish) {
    const Result<V4l2Agreement> agreement = negotiate(wish);
    if (!agreement) return agreement.status().message();
    const V4l2ImageLayout& layout = agreement->layout;
    return fourcc_name(layout.format->fourcc) + " " + std::to_string(layout.width) + "x" + std::to_string(layout.height) + " " +
           std::to_string(std::lround(agreement->rate_hz));
  }
  Status refusal(const V4l2Wish& wish) {
    const Result<V4l2Agreement> agreement = negotiate(wish);
    EXPECT_FALSE(agreement);
    EXPECT_EQ(agreement.status().message().find('\n'), std::string::npos);
    return agreement.status();
  }

  FakeV4l2 io_;
  FakeNode& node_ = io_.add(kPath);
};

V4l2Wish sized(int width, int height) {
  V4l2Wish wish;
  wish.width = width;
  wish.height = height;
  wish.is_width_required = wish.is_height_required = true;
  return wish;
}

V4l2Wish rated(V4l2Wish wish, double rate_hz) {
  wish.rate_hz = rate_hz;
  wish.is_rate_required = true;
  return wish;
}

TEST_F(V4l2Negotiation, TakesWhatComesNearest) {
  EXPECT_EQ(agreed({}), "YUYV 640x480 30") << "cheaper than MJPEG";
  EXPECT_EQ(agreed(sized(1280, 720)), "MJPG 1280x720 30") << "YUYV is too slow there";
  EXPECT_EQ(agreed(rated(sized(1280, 720), 10)), "YUYV 1280x720 10");
  EXPECT_EQ(agreed(sized(320, 240)), "YUYV 320x240 30");
  EXPECT_EQ(agreed(rated({}, 60)), "YUYV 320x240 60");
  EXPECT_EQ(agreed(rated(sized(640, 480), 29.97)), "YUYV 640x480 30");
  V4l2Wish depth;
  depth.role = V4l2Role::kDepth;
  EXPECT_EQ(agreed(depth), "Z16 640x480 30");
  depth.width = 1000;
  EXPECT_EQ(agreed(depth), "Z16 848x480 30");
  V4l2Wish jpeg;
  jpeg.fourcc = V4L2_PIX_FMT_MJPEG;
  EXPECT_EQ(agreed(jpeg), "MJPG 640x480 30");
  EXPECT_NEAR(node_.rate_hz, 30, 1e-9);
}

TEST_F(V4l2Negotiation, ColorIsPreferredOnlyWhereItIsWanted) {
  node_.formats = {{V4L2_PIX_FMT_GREY, {{640, 480, {30}}}}, {V4L2_PIX_FMT_YUYV, {{640, 480, {30}}}}};
  V4l2Wish wish;
  EXPECT_EQ(agreed(wish), "GREY 640x480 30");
  wish.prefers_color = true;
  EXPECT_EQ(agreed(wish), "YUYV 640x480 30");
}

TEST_F(V4l2Negotiation, SizesInSteps) {
  node_.formats = {{V4L2_PIX_FMT_UYVY, {{1920, 1080, {60, 30}, 160, 120, 8}}}};
  EXPECT_EQ(agreed({}), "UYVY 640x480 30");
  EXPECT_EQ(agreed(sized(168, 120)), "UYVY 168x120 30");
  const std::string refused = agreed(sized(169, 120));
  EXPECT_NE(refused.find("UYVY 160x120-1920x1080 (60 30 Hz)"), std::string::npos) << refused;
}

TEST_F(V4l2Negotiation, DriversThatListNeitherSizesNorRates) {
  node_.faults.leaves_out_sizes = node_.faults.leaves_out_rates = true;
  EXPECT_EQ(agreed({}), "YUYV 640x480 30") << "the rates of the size that was asked for are listed";
  node_.formats = {{V4L2_PIX_FMT_YUYV, {}}};
  EXPECT_EQ(agreed({}), "YUYV 640x480 0");
  EXPECT_EQ(agreed(rated({}, 25)), "YUYV 640x480 25");
}

TEST_F(V4l2Negotiation, WithoutRatesFewerBytesAreFaster) {
  node_.faults.leaves_out_rates = true;
  node_.formats = {
      {V4L2_PIX_FMT_Y10BPACK, {{640, 488, {}}}}, {V4L2_PIX_FMT_SGRBG8, {{640, 480, {}}}}, {V4L2_PIX_FMT_UYVY, {{640, 480, {}}}}};
  EXPECT_EQ(agreed({}), "GRBG 640x480 0") << "as the kernel's driver of the Kinect lists them";
}

TEST_F(V4l2Negotiation, SaysWhatIsOffered) {
  const Status status = refusal(rated(sized(800, 600), 30));
  EXPECT_EQ(status.code(), ErrorCode::kUnsupported);
  EXPECT_EQ(status.message(),
            "/dev/video0: 'Fake Camera' does not offer images of 800x600 at 30 Hz; it offers MJPG 640x480 (30 Hz) 1280x720 (30 15 Hz); "
            "YUYV 640x480 (30 15 Hz) 1280x720 (10 Hz) 320x240 (60 30 Hz); Z16 640x480 (30 Hz) 848x480 (90 30 Hz); H264 1920x1080 (30 Hz)");
  V4l2Wish wish;
  wish.fourcc = V4L2_PIX_FMT_UYVY;
  EXPECT_NE(refusal(wish).message().find("images as UYVY"), std::string::npos);
  wish.fourcc = V4L2_PIX_FMT_Z16;
  EXPECT_EQ(refusal(wish).code(), ErrorCode::kUnsupported) << "depth is no image";
  node_.formats.clear();
  EXPECT_NE(refusal({}).message().find("it offers no format at all"), std::string::npos);
}

TEST_F(V4l2Negotiation, FormatsOfTheSameSizesAreOneEntry) {
  node_.formats = {
      {V4L2_PIX_FMT_YUYV, {{640, 480, {30}}}}, {V4L2_PIX_FMT_MJPEG, {{640, 480, {60}}}}, {V4L2_PIX_FMT_UYVY, {{640, 480, {30}}}}};
  const std::string refused = refusal(sized(800, 600)).message();
  EXPECT_TRUE(refused.ends_with("it offers YUYV, UYVY 640x480 (30 Hz); MJPG 640x480 (60 Hz)")) << refused;
}

TEST_F(V4l2Negotiation, ListsThatNeverEnd) {
  node_.faults.never_stops_listing = true;
  EXPECT_EQ(agreed({}), "YUYV 640x480 30");
  EXPECT_LT(refusal(sized(800, 600)).message().size(), 2500U);
}

TEST_F(V4l2Negotiation, RowsAndBuffersAreChecked) {
  node_.padding_bytes = 24;
  const Result<V4l2Agreement> padded = negotiate({});
  ASSERT_TRUE(padded);
  EXPECT_EQ(padded->layout.stride_bytes[0], 1304U);
  node_.faults.bytesperline = 0;  // "no padding", for old drivers
  EXPECT_EQ(negotiate({})->layout.stride_bytes[0], 1280U);
  for (const std::uint32_t stride : {1U, 1279U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    node_.faults.bytesperline = stride;
    EXPECT_EQ(refusal({}).code(), ErrorCode::kCorrupt) << stride;
  }
  node_.faults.bytesperline.reset();
  node_.padding_bytes = 0;
  for (const std::uint32_t bytes : {0U, 1U, 1280U * 480 - 1, 0xFFFFFFFFU}) {
    node_.faults.sizeimage = bytes;
    EXPECT_EQ(refusal({}).code(), ErrorCode::kCorrupt) << bytes;
  }
  node_.faults.sizeimage = 1280 * 480;
  EXPECT_TRUE(negotiate({}));
}

TEST_F(V4l2Negotiation, AnswersThatAreNotWhatWasAskedFor) {
  node_.faults.width_set = 636;
  const Status other_size = refusal({});
  EXPECT_EQ(other_size.code(), ErrorCode::kUnsupported);
  EXPECT_NE(other_size.message().find("the device sets YUYV 636x480"), std::string::npos) << other_size.message();
  node_.faults.width_set.reset();
  node_.faults.fourcc_set = v4l2_fourcc('B', 'G', 'R', '4');  // what v4l2loopback does with Z16
  EXPECT_EQ(refusal({}).code(), ErrorCode::kUnsupported);
  node_.faults.fourcc_set.reset();
  node_.faults.field_set = V4L2_FIELD_ALTERNATE;
  EXPECT_EQ(refusal({}).code(), ErrorCode::kUnsupported);
  node_.faults.field_set.reset();
  node_.faults.is_busy = true;
  EXPECT_EQ(refusal({}).code(), ErrorCode::kUnavailable);
  node_.faults.is_busy = false;
  node_.faults.is_gone = true;
  EXPECT_EQ(V4l2Device::open(io_, kPath).status().code(), ErrorCode::kUnavailable);
}

TEST_F(V4l2Negotiation, EncodingOfColor) {
  EXPECT_FALSE(negotiate({})->layout.encoding.is_full_range);
  node_.colorspace = V4L2_COLORSPACE_JPEG;
  EXPECT_TRUE(negotiate({})->layout.encoding.is_full_range);
  node_.quantization = V4L2_QUANTIZATION_LIM_RANGE;
  EXPECT_FALSE(negotiate({})->layout.encoding.is_full_range);
  node_.colorspace = V4L2_COLORSPACE_REC709;
  EXPECT_TRUE(negotiate({})->layout.encoding.is_bt709);
}

TEST_F(V4l2Negotiation, MultiplanarOnly) {
  node_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  node_.formats = {{V4L2_PIX_FMT_NV12M, {{640, 480, {30}}}}};
  node_.padding_bytes = 64;
  const Result<V4l2Agreement> agreement = negotiate({});
  ASSERT_TRUE(agreement) << agreement.status().message();
  EXPECT_EQ(agreement->layout.stride_bytes[0], 704U);
  EXPECT_EQ(agreement->layout.stride_bytes[1], 704U);
  for (const std::uint32_t planes : {0U, 1U, 3U, 255U}) {
    node_.faults.num_planes_set = planes;
    EXPECT_EQ(refusal({}).code(), ErrorCode::kCorrupt);
  }
}

TEST_F(V4l2Negotiation, NodesThatGiveNoImages) {
  node_.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  EXPECT_EQ(V4l2Device::open(io_, kPath).status().code(), ErrorCode::kUnsupported);
  node_.capabilities = V4L2_CAP_VIDEO_CAPTURE;
  EXPECT_EQ(V4l2Device::open(io_, kPath).status().code(), ErrorCode::kUnsupported);
  EXPECT_EQ(V4l2Device::open(io_, "/dev/video9").status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(io_.num_open(), 0);
}

}  // namespace
}  // namespace camloc
