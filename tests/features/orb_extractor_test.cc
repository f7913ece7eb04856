// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/orb_extractor.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "core/features/hamming.h"
#include "core/features/image_pyramid.h"
#include "tests/features/orb_stages.h"
#include "tests/features/reference_images.h"

namespace camloc {
namespace {

/// cv::ORB multiplies the pixel of the level by the scale; ours is where that pixel lies in the image.
std::vector<Keypoint> to_keypoints(const std::vector<cv::KeyPoint>& reference, const ImagePyramid& pyramid, double scale_factor) {
  std::vector<Keypoint> keypoints;
  for (const cv::KeyPoint& keypoint : reference) {
    const auto scale = static_cast<float>(std::pow(scale_factor, keypoint.octave));
    keypoints.push_back({pyramid.column_on_base(keypoint.octave, std::round(keypoint.pt.x / scale)),
                         pyramid.row_on_base(keypoint.octave, std::round(keypoint.pt.y / scale)), 0, keypoint.response,
                         static_cast<std::uint8_t>(keypoint.octave)});
  }
  return keypoints;
}

Descriptor to_descriptor(const cv::Mat& row) {
  Descriptor descriptor;
  std::memcpy(descriptor.bits.data(), row.data, sizeof(descriptor.bits));
  return descriptor;
}

bool is_same(const Features& a, const Features& b) {
  if (a.size() != b.size() || a.descriptors != b.descriptors) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a.keypoints[i].u != b.keypoints[i].u || a.keypoints[i].v != b.keypoints[i].v ||
        a.keypoints[i].angle_rad != b.keypoints[i].angle_rad || a.keypoints[i].response != b.keypoints[i].response ||
        a.keypoints[i].level != b.keypoints[i].level)
      return false;
  return true;
}

/// scale_factor ^ level, by default.
float scale_of_level(int level) { return std::pow(OrbOptions{}.scale_factor, static_cast<float>(level)); }

/// Describes cv::ORB's keypoints and compares with cv::ORB's descriptors and angles.
void expect_descriptors_of_opencv(const cv::Mat& image, int num_levels, float scale_factor) {
  const auto orb = cv::ORB::create(1500, scale_factor, num_levels);
  std::vector<cv::KeyPoint> reference;
  cv::Mat reference_descriptors;
  orb->detectAndCompute(image, cv::noArray(), reference, reference_descriptors);
  ASSERT_GT(reference.size(), 200U);

  const ImagePyramid pyramid(image.cols, image.rows, num_levels, scale_factor);
  const std::vector<Keypoint> keypoints = to_keypoints(reference, pyramid, static_cast<double>(scale_factor));
  const Features features = describe(view_of(image), keypoints, num_levels, scale_factor);
  ASSERT_EQ(features.size(), reference.size());  // cv::ORB keeps 31 px from the border, more than the 19 px needed
  std::size_t num_equal = 0, sum = 0;
  double worst_angle = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const int distance = hamming_distance(features.descriptors[i], to_descriptor(reference_descriptors.row(static_cast<int>(i))));
    num_equal += distance == 0;
    sum += static_cast<std::size_t>(distance);
    const double angle = reference[i].angle * std::numbers::pi / 180;
    worst_angle = std::max(worst_angle, std::abs(std::remainder(features.keypoints[i].angle_rad - angle, 2 * std::numbers::pi)));
  }
  EXPECT_GE(static_cast<double>(num_equal), 0.995 * static_cast<double>(reference.size()));
  EXPECT_LT(static_cast<double>(sum), 0.5 * static_cast<double>(reference.size()));
  EXPECT_LT(worst_angle, 1e-5);
}

TEST(OrbExtractor, DescribesLikeOpenCv) {
  for (unsigned seed = 0; seed < 3; ++seed) expect_descriptors_of_opencv(textured_image(640, 480, seed), 8, 1.2F);
}

TEST(OrbExtractor, DescribesLikeOpenCvAtOddSizesAndScales) {
  expect_descriptors_of_opencv(textured_image(601, 467, 7), 8, 1.2F);
  expect_descriptors_of_opencv(textured_image(640, 480, 8), 4, 1.5F);
  expect_descriptors_of_opencv(textured_image(512, 424, 9), 3, 2.3F);
  expect_descriptors_of_opencv(textured_image(1283, 721, 10), 8, 1.2F);
}

TEST(OrbExtractor, DescribesPureNoiseLikeOpenCv) { expect_descriptors_of_opencv(noise_image(640, 480, 3), 8, 1.2F); }

TEST(OrbExtractor, KeepsOrderBoundsAndBorder) {
  const cv::Mat image = textured_image(640, 480, 1);
  OrbExtractor extractor(640, 480, OrbOptions{});
  const Features& features = extractor.extract(view_of(image));
  EXPECT_GT(features.size(), 900U);
  EXPECT_LE(features.size(), 1000U);
  ASSERT_EQ(features.keypoints.size(), features.descriptors.size());
  const auto rank = [&](const Keypoint& keypoint) {
    const float scale = scale_of_level(keypoint.level);
    return std::tuple(keypoint.level, std::lrint(keypoint.v / scale), std::lrint(keypoint.u / scale));
  };
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    const float border = 19 * scale_of_level(keypoint.level);
    EXPECT_GE(keypoint.u, border - 0.01F);
    EXPECT_GE(keypoint.v, border - 0.01F);
    EXPECT_LE(keypoint.u, 640 - border);
    EXPECT_LE(keypoint.v, 480 - border);
    EXPECT_GE(keypoint.angle_rad, 0);
    EXPECT_LT(keypoint.angle_rad, 2 * std::numbers::pi);
    EXPECT_GE(keypoint.response, 7);
    if (i > 0) { EXPECT_LT(rank(features.keypoints[i - 1]), rank(keypoint)); }
  }
}

TEST(OrbExtractor, ExtractAndDescribeAgree) {
  const cv::Mat image = textured_image(640, 480, 2);
  OrbExtractor extractor(640, 480, OrbOptions{});
  const Features extracted = extractor.extract(view_of(image));
  const Features described = describe(view_of(image), extracted.keypoints);
  EXPECT_TRUE(is_same(extracted, described));
}

TEST(OrbExtractor, PatchesAreThePixelsAroundTheFeatures) {
  const cv::Mat image = textured_image(601, 467, 6);
  OrbExtractor extractor(601, 467, OrbOptions{});
  const Features features = extractor.extract(view_of(image));
  std::vector<FeaturePatch> patches;
  extractor.copy_patches(&patches);
  ASSERT_EQ(patches.size(), features.size());
  ImagePyramid pyramid(601, 467, 8, 1.2F);
  pyramid.build(view_of(image));
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    const PaddedImage& level = pyramid.level(keypoint.level);
    const auto x = static_cast<int>(std::lround((keypoint.u + 0.5) * level.width / 601 - 0.5));
    const auto y = static_cast<int>(std::lround((keypoint.v + 0.5) * level.height / 467 - 0.5));
    for (const auto [dx, dy] : {std::pair(0, 0), std::pair(-8, -8), std::pair(8, -3), std::pair(5, 8)})
      ASSERT_EQ(patches[i].at(dx, dy), level.row(y + dy)[x + dx]);
  }
}

TEST(OrbExtractor, CoversTheImageEvenly) {
  // Strong texture on the left, weak texture on the right: a third of the features must still be on the right.
  cv::Mat image = textured_image(640, 480, 4);
  cv::Mat right = image(cv::Rect(320, 0, 320, 480));
  right.convertTo(right, -1, 0.25, 90);
  OrbExtractor extractor(640, 480, OrbOptions{});
  const Features& features = extractor.extract(view_of(image));
  std::size_t num_right = 0;
  for (const Keypoint& keypoint : features.keypoints) num_right += keypoint.u > 320;
  EXPECT_GT(3 * num_right, features.size());
}

TEST(OrbExtractor, DoesNotDependOnStride) {
  const cv::Mat image = textured_image(320, 240, 5);
  cv::Mat wide(240, 411, CV_8UC1, cv::Scalar(255));
  image.copyTo(wide(cv::Rect(50, 0, 320, 240)));
  OrbExtractor extractor(320, 240, OrbOptions{});
  const Features packed = extractor.extract(view_of(image));
  EXPECT_TRUE(is_same(packed, extractor.extract(view_of(wide(cv::Rect(50, 0, 320, 240))))));
}

TEST(OrbExtractor, IsDeterministicWhateverCameBefore) {
  const cv::Mat image = textured_image(320, 240, 6), other = noise_image(320, 240, 6);
  OrbExtractor extractor(320, 240, OrbOptions{}), fresh(320, 240, OrbOptions{});
  (void)extractor.extract(view_of(other));
  EXPECT_TRUE(is_same(Features(extractor.extract(view_of(image))), fresh.extract(view_of(image))));
}

TEST(OrbExtractor, FindsMostFeaturesAgainUnderBlurNoiseAndExposure) {
  const cv::Mat image = textured_image(640, 480, 11);
  OrbExtractor extractor(640, 480, OrbOptions{});
  const Features reference = extractor.extract(view_of(image));
  const auto share_found_again = [&](const cv::Mat& changed) {
    const Features& features = extractor.extract(view_of(changed));
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < reference.size(); ++i)
      for (std::size_t j = 0; j < features.size(); ++j) {
        const Keypoint &a = reference.keypoints[i], &b = features.keypoints[j];
        const float reach = 1.5F * scale_of_level(a.level);
        if (std::hypot(a.u - b.u, a.v - b.v) > reach || std::abs(a.level - b.level) > 1) continue;
        if (hamming_distance(reference.descriptors[i], features.descriptors[j]) > 64) continue;
        ++num_found;
        break;
      }
    return static_cast<double>(num_found) / static_cast<double>(reference.size());
  };
  cv::Mat darker, blurred;
  image.convertTo(darker, -1, 0.4, 0);
  cv::GaussianBlur(image, blurred, cv::Size(5, 5), 1.0);
  EXPECT_GT(share_found_again(darker), 0.6);
  EXPECT_GT(share_found_again(blurred), 0.4);
}

TEST(OrbExtractor, SurvivesImagesWithNothingInThem) {
  OrbExtractor extractor(640, 480, OrbOptions{});
  for (const int grey : {0, 128, 255}) {
    const cv::Mat constant(480, 640, CV_8UC1, cv::Scalar(grey));
    EXPECT_EQ(extractor.extract(view_of(constant)).size(), 0U);
  }
  EXPECT_LE(extractor.extract(view_of(noise_image(640, 480, 1))).size(), 1000U);
  EXPECT_EQ(extractor.extract(ImageView<std::uint8_t>{}).size(), 0U);
  EXPECT_EQ(extractor.extract(view_of(noise_image(639, 480, 1))).size(), 0U);
}

TEST(OrbExtractor, SurvivesTinyImages) {
  for (const auto& [width, height] : {std::pair{640, 1}, {1, 480}, {1, 1}, {2, 2}, {38, 38}, {39, 39}, {40, 39}, {39, 60}, {64, 48}}) {
    OrbExtractor extractor(width, height, OrbOptions{});
    const cv::Mat image = noise_image(width, height, 2);
    const Features& features = extractor.extract(view_of(image));
    if (width <= 38 || height <= 38) { EXPECT_EQ(features.size(), 0U); }
  }
}

TEST(OrbExtractor, RespectsTheNumberOfFeatures) {
  const cv::Mat image = textured_image(640, 480, 12);
  for (const int count : {0, 1, 7, 100, 5000}) {
    OrbOptions options;
    options.num_features = count;
    OrbExtractor extractor(640, 480, options);
    EXPECT_LE(extractor.extract(view_of(image)).size(), static_cast<std::size_t>(count));
  }
}

}  // namespace
}  // namespace camloc
