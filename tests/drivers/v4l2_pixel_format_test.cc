// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/v4l2/v4l2_pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace camloc {
namespace {

TEST(V4l2PixelFormat, NamesGoBothWays) {
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) {
    EXPECT_EQ(parse_fourcc(fourcc_name(format.fourcc)), format.fourcc) << fourcc_name(format.fourcc);
    EXPECT_EQ(find_v4l2_pixel_format(format.fourcc), &format);
  }
  EXPECT_EQ(parse_fourcc("z16"), V4L2_PIX_FMT_Z16);
  EXPECT_EQ(parse_fourcc("MJPEG"), V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(parse_fourcc("BGGR"), V4L2_PIX_FMT_SBGGR8);
  EXPECT_EQ(parse_fourcc("Y16-BE"), V4L2_PIX_FMT_Y16_BE);
  EXPECT_FALSE(parse_fourcc("H264"));
  EXPECT_FALSE(parse_fourcc(""));
  EXPECT_EQ(fourcc_name(0x01020A0DU), "????");
}

TEST(V4l2PixelFormat, BytesOfRowsAndPlanes) {
  const auto row = [](std::uint32_t fourcc, int width) { return min_row_bytes(*find_v4l2_pixel_format(fourcc), width); };
  EXPECT_EQ(row(V4L2_PIX_FMT_GREY, 641), 641U);
  EXPECT_EQ(row(V4L2_PIX_FMT_YUYV, 641), 1284U);
  EXPECT_EQ(row(V4L2_PIX_FMT_Z16, 641), 1282U);
  EXPECT_EQ(row(V4L2_PIX_FMT_Y10BPACK, 640), 800U);
  EXPECT_EQ(row(*parse_fourcc("Y11B"), 641), 882U);
  EXPECT_EQ(row(V4L2_PIX_FMT_NV12, 641), 642U);
  const auto plane = [](std::uint32_t fourcc, unsigned index, std::size_t stride) {
    return min_plane_bytes(*find_v4l2_pixel_format(fourcc), index, 6, 5, stride);
  };
  EXPECT_EQ(plane(V4L2_PIX_FMT_GREY, 0, 8), 4U * 8 + 6);
  EXPECT_EQ(plane(V4L2_PIX_FMT_NV12, 0, 8), 5U * 8 + 2 * 8 + 6);
  EXPECT_EQ(plane(V4L2_PIX_FMT_NV12M, 0, 8), 4U * 8 + 6);
  EXPECT_EQ(plane(V4L2_PIX_FMT_NV12M, 1, 8), 2U * 8 + 6);
  EXPECT_EQ(plane(V4L2_PIX_FMT_MJPEG, 0, 0), 0U);
}

}  // namespace
}  // namespace camloc
