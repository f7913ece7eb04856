// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Level by level: corners spread over a grid (corner_selection), the level smoothed (gaussian_blur), then orientation and descriptor
// of each corner (orb_descriptor).
#include "core/features/orb_extractor.h"

#include <algorithm>
#include <cmath>

#include "core/features/orb_descriptor.h"

namespace camloc {
namespace {

/// Share of each level: a geometric series, so that each level has the same density of features per pixel of its width.
std::vector<int> features_per_level(int num_features, int num_levels, float scale_factor) {
  std::vector<int> share(static_cast<std::size_t>(num_levels));
  const double ratio = 1.0 / scale_factor;
  double wanted = num_features * (1 - ratio) / (1 - std::pow(ratio, num_levels));
  int left = num_features;
  for (int& count : share) {
    count = std::min(left, static_cast<int>(std::lround(wanted)));
    left -= count;
    wanted *= ratio;
  }
  if (!share.empty()) share.back() += left;
  return share;
}

}  // namespace

OrbExtractor::OrbExtractor(int width, int height, const OrbOptions& options)
    : pyramid_(width, height, options.num_levels, options.scale_factor),
      share_(features_per_level(options.num_features, pyramid_.num_levels(), options.scale_factor)),
      selector_(width, height, options.num_features),
      blur_(width) {
  blurred_.allocate(width, height);
  features_.keypoints.reserve(static_cast<std::size_t>(options.num_features));
  features_.descriptors.reserve(static_cast<std::size_t>(options.num_features));
}

const Features& OrbExtractor::extract(ImageView<std::uint8_t> image) {
  features_.keypoints.clear();
  features_.descriptors.clear();
  const bool has_right_size = pyramid_.num_levels() > 0 && !image.empty() && image.width == pyramid_.level(0).width &&
                              image.height == pyramid_.level(0).height && image.stride >= image.width;
  if (!has_right_size) return features_;
  pyramid_.build(image);
  int allowed = 0;
  for (int level = 0; level < pyramid_.num_levels(); ++level) {
    // What a level does not use is left to the coarser ones: a blurred image has its corners there.
    allowed += share_[static_cast<std::size_t>(level)];
    extract_level(level, allowed - static_cast<int>(features_.size()));
  }
  return features_;
}

void OrbExtractor::extract_level(int level, int count) {
  const PaddedImage& image = pyramid_.level(level);
  const std::span<const Corner> corners = selector_.select(image, count);
  if (corners.empty()) return;
  blurred_.width = image.width;
  blurred_.height = image.height;
  blur_.apply(image, &blurred_);
  for (const Corner& corner : corners) {
    const float angle_deg = orb_orientation_deg(image.row(corner.y) + corner.x, image.stride);
    features_.descriptors.push_back(orb_descriptor(blurred_.row(corner.y) + corner.x, blurred_.stride, angle_deg));
    features_.keypoints.push_back({pyramid_.column_on_base(level, static_cast<float>(corner.x)),
                                   pyramid_.row_on_base(level, static_cast<float>(corner.y)), orb_angle_rad(angle_deg),
                                   static_cast<float>(corner.score), static_cast<std::uint8_t>(level)});
  }
}

void OrbExtractor::copy_patches(std::vector<FeaturePatch>* patches) const {
  static_assert(FeaturePatch::kHalf <= kOrbBorder);
  patches->resize(features_.size());
  for (std::size_t i = 0; i < patches->size(); ++i) {
    const Keypoint& keypoint = features_.keypoints[i];
    const PaddedImage& level = pyramid_.level(keypoint.level);
    const auto x = static_cast<int>(std::lrint(pyramid_.column_on_level(keypoint.level, keypoint.u)));
    const auto y = static_cast<int>(std::lrint(pyramid_.row_on_level(keypoint.level, keypoint.v)));
    std::uint8_t* out = (*patches)[i].pixels.data();
    for (int dy = -FeaturePatch::kHalf; dy <= FeaturePatch::kHalf; ++dy, out += FeaturePatch::kSide)
      std::copy_n(level.row(y + dy) + x - FeaturePatch::kHalf, FeaturePatch::kSide, out);
  }
}

}  // namespace camloc
