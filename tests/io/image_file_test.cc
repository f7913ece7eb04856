// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/image_file.h"

#include <filesystem>
#include <random>

#include "tests/drivers/test_folder.h"
#include "tests/io/image_messages.h"

namespace camloc {
namespace {

TEST(ImageFile, OnePixelHigh) {
  const TestFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", smooth_color(100, 1)));
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(100, 1)));
  ASSERT_TRUE(write_depth_png(folder / "d.png", ramp_depth(1, 1)));
  Image<std::uint8_t> gray;
  ImageReader reader;
  for (const char* name : {"a.png", "a.jpg"}) {
    ASSERT_TRUE(reader.read_gray(folder / name, &gray).is_ok()) << name;
    EXPECT_EQ(gray.width, 100);
    EXPECT_EQ(gray.height, 1);
  }
  Image<std::uint16_t> depth;
  EXPECT_TRUE(reader.read_depth(folder / "d.png", &depth).is_ok());
}

// Sparse files: only who reads them to their end pays for their size.
TEST(ImageFile, ATailOfAnySizeIsNotRead) {
  const TestFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", smooth_color(32, 24)));
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(32, 24)));
  ASSERT_TRUE(write_depth_png(folder / "d.png", ramp_depth(32, 24)));
  for (const char* name : {"a.png", "a.jpg", "d.png"}) std::filesystem::resize_file(folder / name, std::uintmax_t{1} << 40);
  ImageReader reader;
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;
  EXPECT_TRUE(reader.read_gray(folder / "a.png", &gray).is_ok());
  EXPECT_TRUE(reader.read_gray(folder / "a.jpg", &gray).is_ok());
  EXPECT_TRUE(reader.read_depth(folder / "d.png", &depth).is_ok());
}

TEST(ImageFile, AnImageOfManyBytesIsReadToItsEnd) {
  const TestFolder folder;
  std::mt19937 random(1);
  Image<std::uint16_t> noise;
  noise.resize(1000, 1000);
  for (std::uint16_t& value : noise.pixels) value = static_cast<std::uint16_t>(random());
  ASSERT_TRUE(write_depth_png(folder / "d.png", noise));
  ASSERT_GT(std::filesystem::file_size(folder / "d.png"), 1'500'000U);
  Image<std::uint16_t> depth;
  ImageReader reader;
  ASSERT_TRUE(reader.read_depth(folder / "d.png", &depth).is_ok());
  EXPECT_EQ(depth.pixels, noise.pixels);
}

TEST(ImageFile, TruncatedAnywhereIsAnError) {
  const TestFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", smooth_color(32, 24)));
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(32, 24)));
  ASSERT_TRUE(write_depth_png(folder / "d.png", ramp_depth(32, 24)));
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;
  for (const char* name : {"a.png", "a.jpg"}) {
    const std::vector<std::uint8_t> bytes = bytes_of(folder / name);
    ASSERT_TRUE(decode_gray(bytes, "img", &gray).is_ok());
    // The last two bytes of a JPEG are the end marker; without one of them it is cut as well.
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Status status = decode_gray(std::span(bytes).first(size), "img", &gray);
      ASSERT_EQ(status.code(), ErrorCode::kCorrupt) << name << " cut to " << size << " bytes: " << status.message();
    }
  }
  const std::vector<std::uint8_t> bytes = bytes_of(folder / "d.png");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_FALSE(decode_depth(std::span(bytes).first(size), "img", &depth).is_ok()) << size;
  }
}

TEST(ImageFile, AJpegHoldsNoDepth) {
  Image<std::uint16_t> depth;
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(8, 8)));
  expect_message(decode_depth(bytes_of(folder / "a.jpg"), "img", &depth), ErrorCode::kUnsupported, "cannot hold depth");
}

TEST(ImageFile, NotAnImage) {
  Image<std::uint8_t> gray;
  const std::string text = "hello, this is text";
  expect_message(decode_gray({}, "img", &gray), ErrorCode::kCorrupt, "empty");
  expect_message(decode_gray({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "img", &gray), ErrorCode::kCorrupt,
                 "neither");
  EXPECT_EQ(ImageReader().read_gray("/no/such/file.jpg", &gray).code(), ErrorCode::kNotFound);
  EXPECT_EQ(decode_image_size({}, "img").status().code(), ErrorCode::kCorrupt);
}

TEST(ImageFile, BuffersAreReused) {
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "a.jpg", smooth_color(64, 48)));
  ImageReader reader;
  Image<std::uint8_t> gray;
  ASSERT_TRUE(reader.read_gray(folder / "a.jpg", &gray).is_ok());
  const std::uint8_t* pixels = gray.pixels.data();
  ASSERT_TRUE(reader.read_gray(folder / "a.jpg", &gray).is_ok());
  EXPECT_EQ(gray.pixels.data(), pixels);
}

}  // namespace
}  // namespace camloc
