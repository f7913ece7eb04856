// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Image views and the reuse of image memory.
#include "core/base/frame.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(Image, ViewSeesThePixels) {
  Image<std::uint16_t> image;
  image.resize(3, 2);
  image.at(2, 1) = 7;
  const ImageView<std::uint16_t> view = image.view();
  EXPECT_EQ(view.width, 3);
  EXPECT_EQ(view.height, 2);
  EXPECT_EQ(view.stride, 3);
  EXPECT_FALSE(view.empty());
  EXPECT_EQ(view.at(2, 1), 7);
  EXPECT_EQ(view.row(1), image.row(1));
  image.at(0, 0) = 9;
  EXPECT_EQ(view.at(0, 0), 9) << "a view copies nothing";
}

TEST(Image, ViewFollowsItsStride) {
  const std::vector<std::uint8_t> padded{1, 2, 0, 0, 3, 4, 0, 0};
  const ImageView<std::uint8_t> view{padded.data(), 2, 2, 4};
  EXPECT_EQ(view.at(1, 0), 2);
  EXPECT_EQ(view.at(0, 1), 3);
  EXPECT_EQ(view.at(1, 1), 4);
}

TEST(Image, EmptyIsWhatHasNoPixels) {
  EXPECT_TRUE(ImageView<std::uint8_t>{}.empty());
  const std::uint8_t pixel = 0;
  EXPECT_TRUE((ImageView<std::uint8_t>{&pixel, 0, 5, 0}).empty());
  EXPECT_TRUE((ImageView<std::uint8_t>{&pixel, 5, -1, 5}).empty());
  EXPECT_FALSE((ImageView<std::uint8_t>{&pixel, 1, 1, 1}).empty());
  EXPECT_TRUE(Image<std::uint8_t>{}.view().empty());
}

TEST(Image, ShrinkingAndGrowingBackKeepsTheMemory) {
  Image<std::uint8_t> image;
  image.resize(640, 480);
  const std::uint8_t* const memory = image.pixels.data();
  image.resize(320, 240);
  EXPECT_EQ(image.pixels.size(), 320U * 240U);
  image.resize(640, 480);
  EXPECT_EQ(image.pixels.data(), memory);
}

TEST(FrameBuffer, ViewCarriesStampAndSequence) {
  FrameBuffer buffer;
  buffer.sequence = 12;
  buffer.stamp_ns = 1'700'000'000'000'000'000;
  buffer.gray.resize(4, 3);
  const Frame frame = buffer.view();
  EXPECT_EQ(frame.sequence, 12U);
  EXPECT_EQ(frame.stamp_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(frame.gray.data, buffer.gray.pixels.data());
  EXPECT_TRUE(frame.depth.empty()) << "a camera may deliver no depth";
}

}  // namespace
}  // namespace camloc
