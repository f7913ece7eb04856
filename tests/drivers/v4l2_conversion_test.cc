// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every format against a reader that asks for one pixel at a time, on random bytes, with padded rows and nothing behind the
// last pixel.
#include "drivers/v4l2/v4l2_conversion.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "drivers/raw_pixels.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

struct RawFrame {
  std::array<std::vector<std::uint8_t>, 2> bytes;
  V4l2ImageLayout layout;
  V4l2Planes planes;
};

RawFrame random_frame(std::uint32_t fourcc, int width, int height, std::size_t padding) {
  RawFrame frame;
  frame.layout.format = find_v4l2_pixel_format(fourcc);
  frame.layout.width = width;
  frame.layout.height = height;
  std::mt19937 random(static_cast<unsigned>(width));
  for (unsigned plane = 0; plane < frame.layout.format->num_planes; ++plane) {
    const std::size_t stride = min_row_bytes(*frame.layout.format, width) + padding;
    frame.layout.stride_bytes[plane] = stride;
    frame.bytes[plane].resize(min_plane_bytes(*frame.layout.format, plane, width, height, stride));
    for (std::uint8_t& byte : frame.bytes[plane]) byte = static_cast<std::uint8_t>(random());
    frame.planes[plane] = frame.bytes[plane];
  }
  return frame;
}

/// Bit by bit, whatever the packing.
unsigned word_at(const RawFrame& frame, int x, int y) {
  const std::uint8_t* row = frame.bytes[0].data() + static_cast<std::size_t>(y) * frame.layout.stride_bytes[0];
  const auto at = static_cast<std::size_t>(x);
  if (frame.layout.format->layout == PixelLayout::kWords) return row[2 * at] + 256U * row[2 * at + 1];
  if (frame.layout.format->layout == PixelLayout::kWordsBe) return row[2 * at + 1] + 256U * row[2 * at];
  unsigned value = 0;
  for (std::size_t bit = 0; bit < frame.layout.format->row_bits; ++bit) {
    const std::size_t place = at * frame.layout.format->row_bits + bit;
    value = 2 * value + (row[place / 8] >> (7 - place % 8) & 1U);
  }
  return value;
}

struct Yuv {
  int y, u, v;
};

Yuv yuv_at(const RawFrame& frame, int x, int y) {
  const std::size_t stride = frame.layout.stride_bytes[0];
  const std::uint8_t* row = frame.bytes[0].data() + static_cast<std::size_t>(y) * stride;
  switch (frame.layout.format->fourcc) {
    case V4L2_PIX_FMT_YUYV: return {row[2 * x], row[x / 2 * 4 + 1], row[x / 2 * 4 + 3]};
    case V4L2_PIX_FMT_UYVY: return {row[2 * x + 1], row[x / 2 * 4], row[x / 2 * 4 + 2]};
    case V4L2_PIX_FMT_NV12: {
      const std::uint8_t* chroma = frame.bytes[0].data() + static_cast<std::size_t>(frame.layout.height + y / 2) * stride;
      return {row[x], chroma[x / 2 * 2], chroma[x / 2 * 2 + 1]};
    }
    default: {
      const std::uint8_t* chroma = frame.bytes[1].data() + static_cast<std::size_t>(y / 2) * frame.layout.stride_bytes[1];
      return {row[x], chroma[x / 2 * 2], chroma[x / 2 * 2 + 1]};
    }
  }
}

constexpr std::pair<int, int> kSizes[] = {{2, 2}, {7, 3}, {16, 4}, {33, 5}, {640, 3}, {1025, 2}};
constexpr std::uint32_t kYuvFormats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_NV12M};

TEST(V4l2Conversion, GrayOfYuvIsItsLuma) {
  for (const std::uint32_t fourcc : kYuvFormats) {
    for (const auto& [width, height] : kSizes) {
      for (const std::size_t padding : {std::size_t{0}, std::size_t{5}}) {
        const RawFrame frame = random_frame(fourcc, width, height, padding);
        Image<std::uint8_t> gray;
        ASSERT_TRUE(convert_to_gray(frame.layout, frame.planes, 8, &gray));
        ASSERT_EQ(gray.width, width);
        ASSERT_EQ(gray.height, height);
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) ASSERT_EQ(gray.at(x, y), yuv_at(frame, x, y).y) << fourcc_name(fourcc) << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(V4l2Conversion, ColorOfYuvFollowsItsEncoding) {
  for (const std::uint32_t fourcc : kYuvFormats) {
    for (const YuvEncoding encoding :
         {YuvEncoding{false, false}, YuvEncoding{false, true}, YuvEncoding{true, false}, YuvEncoding{true, true}}) {
      RawFrame frame = random_frame(fourcc, 33, 5, 3);
      frame.layout.encoding = encoding;
      Image<Bgr> color;
      Image<std::uint8_t> scratch;
      ASSERT_TRUE(convert_to_bgr(frame.layout, frame.planes, &scratch, &color));
      const double kr = encoding.is_bt709 ? 0.2126 : 0.299, kb = encoding.is_bt709 ? 0.0722 : 0.114;
      for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 33; ++x) {
          const Yuv yuv = yuv_at(frame, x, y);
          const double luma = encoding.is_full_range ? yuv.y / 255.0 : (yuv.y - 16) / 219.0;
          const double cb = (yuv.u - 128) / (encoding.is_full_range ? 255.0 : 224.0),
                       cr = (yuv.v - 128) / (encoding.is_full_range ? 255.0 : 224.0);
          const double red = luma + 2 * (1 - kr) * cr, blue = luma + 2 * (1 - kb) * cb,
                       green = (luma - kr * red - kb * blue) / (1 - kr - kb);
          const auto level = [](double value) { return std::clamp(255 * value, 0.0, 255.0); };
          EXPECT_NEAR(color.at(x, y).r, level(red), 0.52);
          EXPECT_NEAR(color.at(x, y).g, level(green), 0.52);
          EXPECT_NEAR(color.at(x, y).b, level(blue), 0.52);
        }
      }
    }
  }
}

TEST(V4l2Conversion, DepthKeepsRawValues) {
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) {
    if (!format.can_be_depth) continue;
    for (const auto& [width, height] : kSizes) {
      const RawFrame frame = random_frame(format.fourcc, width, height, 2);
      Image<std::uint16_t> depth;
      convert_to_depth(frame.layout, frame.planes, &depth);
      ASSERT_EQ(depth.width, width);
      ASSERT_EQ(depth.height, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) ASSERT_EQ(depth.at(x, y), word_at(frame, x, y)) << fourcc_name(format.fourcc);
      }
    }
  }
}

TEST(V4l2Conversion, GrayOfInfraredKeepsTheUpperBitsAndSaturates) {
  for (const V4l2PixelFormat& format : v4l2_pixel_formats()) {
    if (!format.can_be_image || !format.can_be_depth) continue;
    for (const unsigned bits : {8U, 10U, 16U}) {
      const RawFrame frame = random_frame(format.fourcc, 1025, 2, 4);
      Image<std::uint8_t> gray;
      ASSERT_TRUE(convert_to_gray(frame.layout, frame.planes, bits, &gray));
      for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 1025; ++x)
          ASSERT_EQ(gray.at(x, y), std::min(word_at(frame, x, y) >> (bits - 8), 255U)) << fourcc_name(format.fourcc);
      }
    }
  }
}

TEST(V4l2Conversion, GrayBytesAndBayer) {
  const RawFrame bytes = random_frame(V4L2_PIX_FMT_GREY, 33, 4, 7);
  Image<std::uint8_t> gray;
  ASSERT_TRUE(convert_to_gray(bytes.layout, bytes.planes, 8, &gray));
  for (int y = 0; y < 4; ++y) EXPECT_TRUE(std::equal(gray.row(y), gray.row(y) + 33, bytes.bytes[0].data() + y * 40));

  for (const auto& [fourcc, order] : {std::pair{V4L2_PIX_FMT_SRGGB8, BayerOrder::kRggb},
                                      {V4L2_PIX_FMT_SGRBG8, BayerOrder::kGrbg},
                                      {V4L2_PIX_FMT_SGBRG8, BayerOrder::kGbrg},
                                      {V4L2_PIX_FMT_SBGGR8, BayerOrder::kBggr}}) {
    const RawFrame mosaic = random_frame(fourcc, 33, 4, 7);
    const ImageView<std::uint8_t> view{mosaic.bytes[0].data(), 33, 4, 40};
    Image<std::uint8_t> expected_gray, scratch;
    Image<Bgr> expected_color, color;
    bayer_to_gray(view, order, &expected_gray);
    bayer_to_bgr(view, order, &expected_color);
    ASSERT_TRUE(convert_to_gray(mosaic.layout, mosaic.planes, 8, &gray));
    ASSERT_TRUE(convert_to_bgr(mosaic.layout, mosaic.planes, &scratch, &color));
    EXPECT_EQ(gray.pixels, expected_gray.pixels);
    EXPECT_TRUE(std::equal(color.pixels.begin(), color.pixels.end(), expected_color.pixels.begin(),
                           [](const Bgr& a, const Bgr& b) { return a.b == b.b && a.g == b.g && a.r == b.r; }));
  }
}

/// A smooth colour gradient: JPEG keeps it to a few levels.
ColorImage gradient(int width, int height) {
  ColorImage image;
  image.width = width;
  image.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int level : {40 + 2 * x, 60 + 3 * y, 200 - x - y}) image.pixels.push_back(static_cast<std::uint8_t>(level));
    }
  }
  return image;
}

class V4l2Jpeg : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_jpeg(folder_ / "frame.jpg", image_, 98));
    bytes_ = bytes_of(folder_ / "frame.jpg");
    layout_.format = find_v4l2_pixel_format(V4L2_PIX_FMT_MJPEG);
    layout_.width = image_.width;
    layout_.height = image_.height;
  }
  void expect_image() {
    Image<std::uint8_t> gray, scratch;
    Image<Bgr> color;
    ASSERT_TRUE(convert_to_gray(layout_, {bytes_, {}}, 8, &gray));
    ASSERT_TRUE(convert_to_bgr(layout_, {bytes_, {}}, &scratch, &color));
    ASSERT_EQ(gray.width, image_.width);
    ASSERT_EQ(color.height, image_.height);
    for (std::size_t i = 0; i < gray.pixels.size(); ++i) {
      const std::uint8_t* rgb = &image_.pixels[3 * i];
      EXPECT_NEAR(gray.pixels[i], 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2], 4);
      EXPECT_NEAR(color.pixels[i].r, rgb[0], 12);
      EXPECT_NEAR(color.pixels[i].g, rgb[1], 12);
      EXPECT_NEAR(color.pixels[i].b, rgb[2], 12);
    }
  }

  TestFolder folder_;
  ColorImage image_ = gradient(64, 48);
  std::vector<std::uint8_t> bytes_;
  V4l2ImageLayout layout_;
};

TEST_F(V4l2Jpeg, IsDecoded) { expect_image(); }

TEST_F(V4l2Jpeg, PaddingBehindTheImageIsFine) {
  bytes_.resize(bytes_.size() + 1000);
  expect_image();
}

// Cameras leave the standard Huffman tables out (AVI1 MJPEG). An encoder that does not optimize writes just these.
TEST_F(V4l2Jpeg, WithoutHuffmanTables) {
  for (std::size_t i = 0; i + 3 < bytes_.size();) {
    if (bytes_[i] != 0xFF || bytes_[i + 1] != 0xC4) {
      ++i;
      continue;
    }
    const std::size_t length = 2 + (std::size_t{bytes_[i + 2]} << 8 | bytes_[i + 3]);
    bytes_.erase(bytes_.begin() + static_cast<std::ptrdiff_t>(i), bytes_.begin() + static_cast<std::ptrdiff_t>(i + length));
  }
  expect_image();
}

TEST_F(V4l2Jpeg, BrokenOnesAreCorrupt) {
  Image<std::uint8_t> gray;
  std::vector<std::uint8_t> cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(bytes_.size() / 2));
  EXPECT_EQ(convert_to_gray(layout_, {cut, {}}, 8, &gray).code(), ErrorCode::kCorrupt);
  cut.assign(100, 0x55);
  EXPECT_EQ(convert_to_gray(layout_, {cut, {}}, 8, &gray).code(), ErrorCode::kCorrupt);
  layout_.width = 128;
  const Status other_size = convert_to_gray(layout_, {bytes_, {}}, 8, &gray);
  EXPECT_EQ(other_size.code(), ErrorCode::kCorrupt);
  EXPECT_NE(other_size.message().find("64x48"), std::string::npos) << other_size.message();
}

}  // namespace
}  // namespace camloc
