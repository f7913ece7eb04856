// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/image_writer.h"

#include "core/io/image_file.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

TEST(ImageWriter, PngKeepsGrayAndColor) {
  const TestFolder folder;
  const ColorImage color = smooth_color(40, 30, 5);
  ASSERT_TRUE(write_png(folder / "c.png", color).is_ok());
  EXPECT_EQ(ImageReader().read_color(folder / "c.png")->pixels, color.pixels);
  Image<std::uint8_t> gray;
  gray.resize(7, 3);
  for (std::size_t i = 0; i < gray.pixels.size(); ++i) gray.pixels[i] = static_cast<std::uint8_t>(12 * i);
  ASSERT_TRUE(write_png(folder / "g.png", gray).is_ok());
  Image<std::uint8_t> read;
  ASSERT_TRUE(ImageReader().read_gray(folder / "g.png", &read).is_ok());
  EXPECT_EQ(read.pixels, gray.pixels);
}

TEST(ImageWriter, NoCompressionChangesAPixel) {
  const TestFolder folder;
  const ColorImage color = smooth_color(61, 47, 3);
  const Image<std::uint16_t> depth = ramp_depth(61, 47, 9);
  for (const PngCompression compression : {PngCompression::kPicture, PngCompression::kFast, PngCompression::kSmall}) {
    ASSERT_TRUE(write_png(folder / "c.png", color, compression).is_ok());
    EXPECT_EQ(ImageReader().read_color(folder / "c.png")->pixels, color.pixels);
    ASSERT_TRUE(write_depth_png(folder / "d.png", depth, compression).is_ok());
    Image<std::uint16_t> read;
    ASSERT_TRUE(ImageReader().read_depth(folder / "d.png", &read).is_ok());
    EXPECT_EQ(read.pixels, depth.pixels);
  }
}

TEST(ImageWriter, LowerQualityIsSmaller) {
  const TestFolder folder;
  ASSERT_TRUE(write_jpeg(folder / "good.jpg", smooth_color(200, 200), 98).is_ok());
  ASSERT_TRUE(write_jpeg(folder / "poor.jpg", smooth_color(200, 200), 20).is_ok());
  EXPECT_LT(std::filesystem::file_size(folder / "poor.jpg"), std::filesystem::file_size(folder / "good.jpg"));
}

TEST(ImageWriter, ErrorsNameFileAndReason) {
  const Status missing = write_png("/no/such/folder/a.png", smooth_color(8, 8));
  EXPECT_EQ(missing.code(), ErrorCode::kIo);
  EXPECT_NE(missing.message().find("/no/such/folder/a.png: No such file"), std::string::npos) << missing.message();
  EXPECT_FALSE(write_jpeg("/no/such/folder/a.jpg", smooth_color(8, 8)).is_ok());
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TestFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "full.png");
  const Status full = write_depth_png(folder / "full.png", ramp_depth(64, 64));
  EXPECT_EQ(full.code(), ErrorCode::kIo);
  EXPECT_NE(full.message().find("No space left"), std::string::npos) << full.message();
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "full.png"));
}

}  // namespace
}  // namespace camloc
