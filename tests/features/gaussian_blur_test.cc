// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/gaussian_blur.h"

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

/// cv::GaussianBlur of a part of a larger image whose surroundings are the mirrored image, as inside cv::ORB.
cv::Mat blurred_as_in_orb(const cv::Mat& image) {
  cv::Mat larger;
  cv::copyMakeBorder(image, larger, 8, 8, 8, 8, cv::BORDER_REFLECT_101);
  cv::Mat out;
  cv::GaussianBlur(larger(cv::Rect(8, 8, image.cols, image.rows)), out, cv::Size(7, 7), 2, 2, cv::BORDER_REFLECT_101);
  return out;
}

TEST(GaussianBlur, EqualsWhatOrbSees) {
  int num_different = 0, num_pixels = 0;
  for (const auto& [width, height] :
       {std::pair{640, 480}, {533, 400}, {179, 134}, {33, 9}, {7, 7}, {4, 4}, {3, 5}, {5, 3}, {2, 40}, {64, 2}}) {
    for (const cv::Mat& image : {noise_image(width, height, 5), cv::Mat(height, width, CV_8UC1, cv::Scalar(255))}) {
      const cv::Mat expected = blurred_as_in_orb(image);
      const PaddedImage src = padded(image);
      PaddedImage dst;
      dst.allocate(width, height);
      GaussianBlur blur(width);
      blur.apply(src, &dst);
      num_pixels += width * height;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const int difference = std::abs(dst.row(y)[x] - expected.at<std::uint8_t>(y, x));
          ASSERT_LE(difference, 1) << width << " x " << height;
          num_different += difference;
        }
    }
  }
  EXPECT_LT(num_different, 1e-4 * num_pixels);
}

}  // namespace
}  // namespace camloc
