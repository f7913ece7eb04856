// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Grey and colour of a JPEG, sizes that are refused, damage that libjpeg would repair.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/io/image_file.h"
#include "tests/drivers/test_folder.h"
#include "tests/io/image_messages.h"

namespace camloc {
namespace {

TEST(JpegDecoder, GrayFromColorHasTheLumaOfItsColors) {
  const TestFolder folder;
  const ColorImage color = smooth_color(61, 47);
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", color));
  ImageReader reader;
  Image<std::uint8_t> gray;
  ASSERT_TRUE(reader.read_gray(folder / "a.jpg", &gray).is_ok());
  ASSERT_EQ(gray.width, 61);
  ASSERT_EQ(gray.height, 47);
  ASSERT_EQ(gray.pixels.size(), 61U * 47U);
  double sum = 0;
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) sum += std::abs(gray.pixels[i] - expected_luma(&color.pixels[3 * i]));
  EXPECT_LT(sum / static_cast<double>(gray.pixels.size()), 2.0);
  const auto decoded = reader.read_color(folder / "a.jpg");
  ASSERT_TRUE(decoded.is_ok());
  sum = 0;
  for (std::size_t i = 0; i < color.pixels.size(); ++i) sum += std::abs(color.pixels[i] - decoded->pixels[i]);
  EXPECT_LT(sum / static_cast<double>(color.pixels.size()), 6.0);
}

TEST(JpegDecoder, GrayImage) {
  const TestFolder folder;
  const std::vector<std::uint8_t> pixels(20 * 10, 77);
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", {pixels.data(), 20, 10, 1}));
  Image<std::uint8_t> gray;
  ASSERT_TRUE(ImageReader().read_gray(folder / "a.jpg", &gray).is_ok());
  EXPECT_EQ(gray.pixels, pixels);
  EXPECT_EQ(ImageReader().read_color(folder / "a.jpg")->pixels.size(), 600U);
}

TEST(JpegDecoder, HugeSizesAreRefusedBeforeAllocating) {
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(8, 8)));
  std::vector<std::uint8_t> bytes = bytes_of(folder / "a.jpg");
  for (std::size_t i = 0; i + 9 < bytes.size(); ++i) {
    if (bytes[i] != 0xFF || bytes[i + 1] != 0xC0) continue;  // frame header: height and width follow
    bytes[i + 5] = bytes[i + 7] = 0x3F;
    bytes[i + 6] = bytes[i + 8] = 0xFF;
    break;
  }
  Image<std::uint8_t> gray;
  expect_message(decode_gray(bytes, "img", &gray), ErrorCode::kUnsupported, "16383x16383");
  EXPECT_TRUE(gray.pixels.empty());
}

// libjpeg goes on behind damage with a warning and grey pixels, and those would be localized against.
TEST(JpegDecoder, ARepairedImageIsAnError) {
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(64, 48)));
  const std::vector<std::uint8_t> good = bytes_of(folder / "a.jpg");
  const std::array<std::uint8_t, 2> scan = {0xFF, 0xDA};
  const auto begin = std::search(good.begin(), good.end(), scan.begin(), scan.end()) + 20;
  ASSERT_LT(begin, good.end() - 40);
  std::vector<std::uint8_t> bad = good;  // an end marker in the middle of the pixels
  const auto middle = bad.begin() + (begin - good.begin()) + 10;
  middle[0] = 0xFF;
  middle[1] = 0xD9;
  Image<std::uint8_t> gray;
  ASSERT_TRUE(decode_gray(good, "img", &gray).is_ok());
  EXPECT_EQ(decode_gray(bad, "img", &gray).code(), ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace camloc
