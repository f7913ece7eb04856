// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/image_pyramid.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/features/reference_images.h"

namespace camloc {
namespace {

PaddedImage padded_copy(const cv::Mat& image) {
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
void PrintTo(const Sizes& sizes, std::ostream* out) {
  *out << sizes.src_width << 'x' << sizes.src_height << " to " << sizes.dst_width << 'x' << sizes.dst_height;
}

class ExactResizeTest : public ::testing::TestWithParam<Sizes> {};

TEST_P(ExactResizeTest, EqualsOpenCv) {
  const Sizes sizes = GetParam();
  const cv::Mat image = noise_image(sizes.src_width, sizes.src_height, 1);
  cv::Mat expected;
  cv::resize(image, expected, cv::Size(sizes.dst_width, sizes.dst_height), 0, 0, cv::INTER_LINEAR_EXACT);
  const PaddedImage src = padded_copy(image);
  PaddedImage dst;
  dst.allocate(sizes.dst_width, sizes.dst_height);
  ExactResize resize(sizes.src_width, sizes.src_height, sizes.dst_width, sizes.dst_height);
  resize.apply(src, &dst);
  EXPECT_EQ(cv::countNonZero(mat_of(dst) != expected), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ExactResizeTest,
                         ::testing::Values(Sizes{640, 480, 533, 400}, Sizes{533, 400, 444, 333}, Sizes{444, 333, 370, 278},
                                           Sizes{641, 479, 534, 399}, Sizes{100, 100, 43, 91}, Sizes{17, 3, 14, 2}, Sizes{5, 5, 4, 4},
                                           Sizes{640, 1, 533, 1}, Sizes{2, 2, 1, 1}, Sizes{333, 33, 111, 11}, Sizes{31, 29, 62, 58},
                                           Sizes{300, 200, 300, 150}));

TEST(ImagePyramid, LevelsEqualRepeatedOpenCvResize) {
  const cv::Mat image = textured_image(640, 480, 1);
  ImagePyramid pyramid(640, 480, 8, 1.2F);
  pyramid.build(view_of(image));
  ASSERT_EQ(pyramid.num_levels(), 8);
  cv::Mat expected = image;
  for (int level = 0; level < 8; ++level) {
    const float scale = static_cast<float>(std::pow(static_cast<double>(1.2F), level));
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

/// Where the edge between dark on the left and bright on the right lies in the first row, counted from the image's border.
double edge_of(const PaddedImage& image) {
  double dark = 0;
  for (int x = 0; x < image.width; ++x) dark += (220.0 - image.row(0)[x]) / 200.0;
  return dark;
}

// Edges at known columns, twenty side by side to be rid of the sampling.
TEST(ImagePyramid, KnowsWhereItsPixelsLie) {
  constexpr int kWidth = 640, kHeight = 470;
  ImagePyramid pyramid(kWidth, kHeight, 8, 1.2F);
  for (const int middle : {60, 320, 590}) {
    std::array<double, 8> mean_error{};
    for (int edge = middle - 10; edge < middle + 10; ++edge) {
      cv::Mat image(kHeight, kWidth, CV_8UC1, cv::Scalar(220));
      image.colRange(0, edge) = 20;
      pyramid.build(view_of(image));
      for (int level = 0; level < 8; ++level) {
        const auto at = static_cast<float>(edge_of(pyramid.level(level)) - 0.5);
        mean_error[static_cast<std::size_t>(level)] += (pyramid.column_on_base(level, at) + 0.5 - edge) / 20;
      }
    }
    for (int level = 0; level < 8; ++level) EXPECT_NEAR(mean_error[static_cast<std::size_t>(level)], 0, 0.15) << level << " " << middle;
  }
  for (int level = 0; level < 8; ++level) {
    EXPECT_NEAR(pyramid.row_on_base(level, static_cast<float>(pyramid.level(level).height) - 0.5F), kHeight - 0.5, 1e-3);
    EXPECT_NEAR(pyramid.row_on_base(level, -0.5F), -0.5, 1e-3);
    EXPECT_NEAR(pyramid.column_on_level(level, pyramid.column_on_base(level, 31)), 31, 1e-3);
    EXPECT_NEAR(pyramid.row_on_level(level, pyramid.row_on_base(level, 31)), 31, 1e-3);
  }
}

}  // namespace
}  // namespace camloc
