// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Kinds of PNG beside those that image_writer writes, and damage.
#include <png.h>

#include "core/io/image_file.h"
#include "tests/drivers/test_folder.h"
#include "tests/io/image_messages.h"

namespace camloc {
namespace {

/// libpng's simple interface as an independent writer: kinds image_writer does not write.
std::vector<std::uint8_t> encode_png(const void* pixels, int width, int height, png_uint_32 format, const void* colormap = nullptr) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  image.colormap_entries = 4;
  png_alloc_size_t size = 0;
  EXPECT_NE(png_image_write_to_memory(&image, nullptr, &size, 0, pixels, 0, colormap), 0) << image.message;
  std::vector<std::uint8_t> bytes(size);
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, colormap), 0) << image.message;
  bytes.resize(size);
  return bytes;
}

TEST(PngDecoder, KindsBecomeGray) {
  const ColorImage color = smooth_color(13, 9);
  std::vector<std::uint8_t> rgba, indices(13 * 9), gray_alpha;
  for (std::size_t i = 0; i < 13 * 9; ++i) {
    rgba.insert(rgba.end(), {color.pixels[3 * i], color.pixels[3 * i + 1], color.pixels[3 * i + 2], 255});
    indices[i] = static_cast<std::uint8_t>(i % 4);
    gray_alpha.insert(gray_alpha.end(), {static_cast<std::uint8_t>(i), 255});
  }
  Image<std::uint8_t> gray;
  for (const auto& bytes : {encode_png(color.pixels.data(), 13, 9, PNG_FORMAT_RGB), encode_png(rgba.data(), 13, 9, PNG_FORMAT_RGBA)}) {
    ASSERT_TRUE(decode_gray(bytes, "img", &gray).is_ok());
    ASSERT_EQ(gray.pixels.size(), 13U * 9U);
    for (std::size_t i = 0; i < gray.pixels.size(); ++i) ASSERT_NEAR(gray.pixels[i], expected_luma(&color.pixels[3 * i]), 1);
    EXPECT_EQ(decode_color(bytes, "img")->pixels, color.pixels);
  }
  ASSERT_TRUE(decode_gray(encode_png(gray_alpha.data(), 13, 9, PNG_FORMAT_GA), "img", &gray).is_ok());
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) ASSERT_EQ(gray.pixels[i], i);
  const std::uint8_t palette[4][3] = {{0, 0, 0}, {10, 10, 10}, {200, 200, 200}, {255, 255, 255}};
  ASSERT_TRUE(decode_gray(encode_png(indices.data(), 13, 9, PNG_FORMAT_RGB_COLORMAP, palette), "img", &gray).is_ok());
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) ASSERT_EQ(gray.pixels[i], palette[i % 4][0]);
}

TEST(PngDecoder, InterlacedImagesComeInOnePiece) {
  // 8x8, interlaced, every byte of row y is 16 * y; made with another encoder.
  const TestFolder folder;
  std::vector<std::uint8_t> bytes;
  {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &bytes,
        [](png_structp p, png_bytep data, std::size_t size) {
          auto* out = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
          out->insert(out->end(), data, data + size);
        },
        nullptr);
    png_set_IHDR(png, info, 8, 8, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    std::vector<std::vector<std::uint8_t>> rows;
    std::vector<png_bytep> pointers;
    for (int y = 0; y < 8; ++y) rows.emplace_back(8, static_cast<std::uint8_t>(16 * y));
    for (auto& row : rows) pointers.push_back(row.data());
    png_write_info(png, info);
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
  }
  Image<std::uint8_t> gray;
  ASSERT_TRUE(decode_gray(bytes, "img", &gray).is_ok());
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) ASSERT_EQ(gray.at(x, y), 16 * y);
  }
}

TEST(PngDecoder, FlippedBytesAreNoticed) {
  const TestFolder folder;
  ASSERT_TRUE(write_depth_png(folder / "d.png", ramp_depth(8, 8)));
  const std::vector<std::uint8_t> good = bytes_of(folder / "d.png");
  Image<std::uint16_t> depth;
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<std::uint8_t> bad = good;
    bad[i] ^= 0x10;
    const Status status = decode_depth(bad, "img", &depth);
    if (status) { EXPECT_EQ(depth.pixels, ramp_depth(8, 8).pixels) << "byte " << i; }  // an ancillary chunk's name
  }
}

TEST(PngDecoder, SixteenBitColourGivesItsUpperEight) {
  std::vector<std::uint16_t> wide;
  for (int i = 0; i < 8 * 8 * 3; ++i) wide.push_back(static_cast<std::uint16_t>(256 * i + 255 - i));
  // libpng writes linear values as they are, with sixteen bits.
  const auto color = decode_color(encode_png(wide.data(), 8, 8, PNG_FORMAT_LINEAR_RGB), "img");
  ASSERT_TRUE(color.is_ok()) << color.status().message();
  Image<std::uint8_t> gray;
  ASSERT_TRUE(decode_gray(encode_png(wide.data(), 8, 8, PNG_FORMAT_LINEAR_RGB), "img", &gray).is_ok());
  for (std::size_t i = 0; i < wide.size(); ++i) ASSERT_EQ(color->pixels[i], wide[i] >> 8);
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) ASSERT_NEAR(gray.pixels[i], expected_luma(&color->pixels[3 * i]), 1);
}

TEST(PngDecoder, WrongKindsSayWhatIsExpected) {
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;
  const std::vector<std::uint16_t> wide(8 * 8 * 3, 1000);
  const std::vector<std::uint8_t> narrow(8 * 8, 100);
  expect_message(decode_depth(encode_png(narrow.data(), 8, 8, PNG_FORMAT_GRAY), "img", &depth), ErrorCode::kUnsupported,
                 "8-bit grey image, expected 16-bit");
  expect_message(decode_gray(encode_png(wide.data(), 8, 8, PNG_FORMAT_LINEAR_Y), "img", &gray), ErrorCode::kUnsupported,
                 "16-bit grey image, expected 8 bits; convert it");
  expect_message(decode_depth(encode_png(wide.data(), 8, 8, PNG_FORMAT_LINEAR_RGB), "img", &depth), ErrorCode::kUnsupported,
                 "16-bit colour");
}

TEST(PngDecoder, DepthKeepsEveryBit) {
  const TestFolder folder;
  const Image<std::uint16_t> depth = ramp_depth(31, 17);
  ASSERT_TRUE(write_depth_png(folder / "d.png", depth));
  Image<std::uint16_t> read;
  ASSERT_TRUE(ImageReader().read_depth(folder / "d.png", &read).is_ok());
  EXPECT_EQ(read.pixels, depth.pixels);
  EXPECT_EQ(read.width, 31);
  const auto size = ImageReader().read_size(folder / "d.png");
  ASSERT_TRUE(size.is_ok());
  EXPECT_EQ(size->width, 31);
  EXPECT_EQ(size->height, 17);
}

}  // namespace
}  // namespace camloc
