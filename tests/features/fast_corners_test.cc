// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/fast_corners.h"

#include <gtest/gtest.h>

#include <map>
#include <opencv2/features2d.hpp>

#include "tests/features/reference_images.h"

namespace camloc {
namespace {

constexpr int kMargin = 3;

/// Scores of the pixels three or more from the border, 0 elsewhere. The image has 64 columns of padding to the right.
cv::Mat scores_of(const cv::Mat& image, int threshold, const FastKernel& kernel) {
  cv::Mat wide(image.rows, image.cols + 64, CV_8UC1, cv::Scalar(77)), scores(image.size(), CV_8UC1, cv::Scalar(0));
  image.copyTo(wide(cv::Rect(0, 0, image.cols, image.rows)));
  for (int y = kMargin; y < image.rows - kMargin; ++y)
    kernel.scores(wide.ptr(y) + kMargin, static_cast<std::ptrdiff_t>(wide.step), image.cols - 2 * kMargin, threshold,
                  scores.ptr(y) + kMargin);
  return scores;
}

TEST(FastCorners, AgreesWithOpenCvOnCornersAndScores) {
  for (const cv::Mat& image : {textured_image(320, 240, 1), noise_image(200, 150, 2)})
    for (const int threshold : {7, 20, 60}) {
      std::vector<cv::KeyPoint> corners;
      cv::FAST(image, corners, threshold, false);
      cv::Mat is_corner(image.size(), CV_8UC1, cv::Scalar(0));
      for (const auto& corner : corners) is_corner.at<std::uint8_t>(corner.pt) = 255;
      const cv::Mat scores = scores_of(image, threshold, available_fast_kernels().front());
      EXPECT_EQ(cv::countNonZero((scores > 0) != is_corner), 0) << "threshold " << threshold;

      // OpenCV scores only what survives its non-maximum suppression.
      cv::FAST(image, corners, threshold, true);
      ASSERT_FALSE(corners.empty());
      for (const auto& corner : corners) EXPECT_EQ(scores.at<std::uint8_t>(corner.pt), corner.response);
    }
}

TEST(FastCorners, AllKernelsGiveTheSameScores) {
  for (const FastKernel& kernel : available_fast_kernels())
    for (const int width : {38, 39, 64, 71, 200})
      for (const int threshold : {1, 7, 20, 200, 254})
        for (const cv::Mat& image : {noise_image(width, 60, 3), textured_image(width, 60, 4)}) {
          const cv::Mat expected = scores_of(image, threshold, available_fast_kernels().front());
          EXPECT_EQ(cv::countNonZero(scores_of(image, threshold, kernel) != expected), 0)
              << kernel.name << " width " << width << " threshold " << threshold;
        }
}

TEST(FastCorners, AllKernelsAgreeOnExtremes) {
  // Only black and white: differences of 255, scores of 254.
  const cv::Mat image = noise_image(150, 60, 5) > 100;
  const cv::Mat expected = scores_of(image, 7, available_fast_kernels().front());
  EXPECT_GT(cv::countNonZero(expected == 254), 0);
  for (const FastKernel& kernel : available_fast_kernels())
    EXPECT_EQ(cv::countNonZero(scores_of(image, 7, kernel) != expected), 0) << kernel.name;
}

TEST(FastCorners, ScoreIsTheLargestThresholdThatPasses) {
  const cv::Mat image = textured_image(100, 80, 6);
  const cv::Mat scores = scores_of(image, 7, available_fast_kernels().back());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; x += 5) {
      const int score = scores.at<std::uint8_t>(y, x);
      if (score == 0) continue;
      EXPECT_EQ(scores_of(image, score, available_fast_kernels().back()).at<std::uint8_t>(y, x), score);
      EXPECT_EQ(scores_of(image, score + 1, available_fast_kernels().back()).at<std::uint8_t>(y, x), 0);
    }
}

TEST(FastCorners, WritesOnlyItsOwnScores) {
  const cv::Mat image = noise_image(200, 7, 7);
  for (const FastKernel& kernel : available_fast_kernels())
    for (int count = 1; count < 70; ++count) {
      std::vector<std::uint8_t> scores(140, 99);
      kernel.scores(image.ptr(3) + 3, static_cast<std::ptrdiff_t>(image.step), count, 7, scores.data() + 10);
      for (int i = 0; i < 140; ++i)
        if (i < 10 || i >= 10 + count) { ASSERT_EQ(scores[static_cast<std::size_t>(i)], 99) << kernel.name << " count " << count; }
    }
}

}  // namespace
}  // namespace camloc
