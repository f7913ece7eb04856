// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Images for the feature tests: generated texture, and frames of the kitchen sequence where the data is at hand.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "core/base/frame.h"

namespace camloc {

inline ImageView<std::uint8_t> view_of(const cv::Mat& image) { return {image.data, image.cols, image.rows, static_cast<int>(image.step)}; }

/// Overlapping rectangles and discs of random grey under mild noise: corners at all scales, flat parts in between.
inline cv::Mat textured_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < width * height / 1500; ++i) {
    const cv::Point centre(below(width), below(height));
    const cv::Scalar grey(below(256));
    const int size = 3 + below(40);
    if (i % 3 == 0)
      cv::circle(image, centre, size / 2 + 1, grey, cv::FILLED);
    else
      cv::rectangle(image, cv::Rect(centre, cv::Size(size, 3 + below(40))), grey, cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.8);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(image.at<std::uint8_t>(y, x) + below(7) - 3);
  return image;
}

inline cv::Mat noise_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random());
  return image;
}

}  // namespace camloc
