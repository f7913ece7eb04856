// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/image_pyramid.h"

#include <gtest/gtest.h>

#include "tests/features/reference_images.h"

namespace camloc {
namespace {

PaddedImage padded(const cv::Mat& image) {
  PaddedImage out;
  out.allocate(image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) std::copy_n(image.ptr(y), image.cols, out.row(y));
  return out;
}

cv::Mat mat_of(const PaddedImage& image) {
  cv::Mat out(image.height, image.width, CV_8UC1);
  for (int y = 0; y < image.height; ++y) std::copy_n(image.row(y), image.width, out.ptr(y));
  return out;
}

struct Sizes {
  int src_width, src_height, dst_width, dst_height;
};

class ExactResizeTest : public testing::TestWithParam<Sizes> {};

TEST_P(ExactResizeTest, EqualsOpenCv) {
  const Sizes sizes = GetParam();
  const cv::Mat image = noise_image(sizes.src_width, sizes.src_height, 1);
  cv::Mat expected;
  cv::resize(image, expected, cv::Size(sizes.dst_width, sizes.dst_height), 0, 0, cv::INTER_LINEAR_EXACT);
  const PaddedImage src = padded(image);
  PaddedImage dst;
  dst.allocate(sizes.dst_width, sizes.dst_height);
  ExactResize resize(sizes.src_width, sizes.src_height, sizes.dst_width, sizes.dst_height);
  resize.apply(src, &dst);
  EXPECT_EQ(cv::countNonZero(mat_of(dst) != expected), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ExactResizeTest,
                         testing::Values(Sizes{640, 480, 533, 400}, Sizes{533, 400, 444, 333}, Sizes{444, 333, 370, 278},
                                         Sizes{641, 479, 534, 399}, Sizes{100, 100, 43, 91}, Sizes{17, 3, 14, 2},
                                         Sizes{5, 5, 4, 4}, Sizes{640, 1, 533, 1}, Sizes{2, 2, 1, 1}, Sizes{333, 33, 111, 11},
                                         Sizes{31, 29, 62, 58}, Sizes{300, 200, 300, 150}));

TEST(ImagePyramid, LevelsEqualRepeatedOpenCvResize) {
  const cv::Mat image = textured_image(640, 480, 1);
  ImagePyramid pyramid(640, 480, 8, 1.2F);
  pyramid.build(view_of(image));
  ASSERT_EQ(pyramid.num_levels(), 8);
  cv::Mat expected = image;
  for (int level = 0; level < 8; ++level) {
    const float scale = pyramid.scale(level);
    const cv::Size size(cvRound(640 / scale), cvRound(480 / scale));
    if (level > 0) cv::resize(expected.clone(), expected, size, 0, 0, cv::INTER_LINEAR_EXACT);
    ASSERT_EQ(pyramid.level(level).width, size.width);
    ASSERT_EQ(pyramid.level(level).height, size.height);
    EXPECT_EQ(cv::countNonZero(mat_of(pyramid.level(level)) != expected), 0) << "level " << level;
  }
}

TEST(ImagePyramid, StopsWhereNothingIsLeft) {
  EXPECT_EQ(ImagePyramid(640, 1, 8, 1.2F).num_levels(), 4);
  EXPECT_EQ(ImagePyramid(1, 1, 8, 3.F).num_levels(), 1);
}

}  // namespace
}  // namespace camloc
