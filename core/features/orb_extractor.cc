// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/orb_extractor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/features/corner_selection.h"
#include "core/features/gaussian_blur.h"
#include "core/features/image_pyramid.h"
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

float radians_from_degrees(float angle_deg) {
  const float angle_rad = angle_deg * static_cast<float>(std::numbers::pi / 180.0);
  return angle_rad < static_cast<float>(2 * std::numbers::pi) ? angle_rad : 0.F;
}

CornerOptions corner_options(const OrbOptions& options) {
  return {options.fast_threshold, options.min_fast_threshold, options.cell_px, kOrbBorder};
}

}  // namespace

struct OrbExtractor::Impl {
  Impl(int width, int height, const OrbOptions& orb_options)
      : options(orb_options),
        pyramid(width, height, orb_options.num_levels, orb_options.scale_factor),
        share(features_per_level(orb_options.num_features, pyramid.num_levels(), orb_options.scale_factor)),
        selector(width, height, orb_options.num_features, corner_options(orb_options)),
        blur(width) {
    blurred.allocate(width, height);
    features.keypoints.reserve(static_cast<std::size_t>(orb_options.num_features));
    features.descriptors.reserve(static_cast<std::size_t>(orb_options.num_features));
  }

  /// Makes `blurred` the smoothed level.
  void blur_level(const PaddedImage& level) {
    blurred.width = level.width;
    blurred.height = level.height;
    blur.apply(level, 0, level.height, &blurred);
  }

  void extract_level(int level, int count) {
    const PaddedImage& image = pyramid.level(level);
    const std::span<const Corner> corners = selector.select(image, count);
    if (corners.empty()) return;
    blur_level(image);
    for (const Corner& corner : corners) {
      Keypoint keypoint{pyramid.column_on_base(level, static_cast<float>(corner.x)),
                        pyramid.row_on_base(level, static_cast<float>(corner.y)), 0, static_cast<float>(corner.score),
                        static_cast<std::uint8_t>(level)};
      features.descriptors.push_back(describe_at(image, corner.x, corner.y, &keypoint));
      features.keypoints.push_back(keypoint);
    }
  }

  /// Descriptor at a pixel of the level whose smoothed image is in `blurred`; sets the keypoint's angle.
  Descriptor describe_at(const PaddedImage& image, int x, int y, Keypoint* keypoint) const {
    const float angle_deg = orb_orientation_deg(image.row(y) + x, image.stride);
    keypoint->angle_rad = radians_from_degrees(angle_deg);
    return orb_descriptor(blurred.row(y) + x, blurred.stride, angle_deg);
  }

  [[nodiscard]] bool has_size_of(ImageView<std::uint8_t> image) const {
    return pyramid.num_levels() > 0 && !image.empty() && image.width == pyramid.level(0).width && image.height == pyramid.level(0).height &&
           image.stride >= image.width;
  }

  /// The pixel of its level that a keypoint is on.
  [[nodiscard]] int column_of(const Keypoint& k) const { return static_cast<int>(std::lrint(pyramid.column_on_level(k.level, k.u))); }
  [[nodiscard]] int row_of(const Keypoint& k) const { return static_cast<int>(std::lrint(pyramid.row_on_level(k.level, k.v))); }

  void clear() {
    features.keypoints.clear();
    features.descriptors.clear();
  }

  OrbOptions options;
  ImagePyramid pyramid;
  std::vector<int> share;  ///< features of each level
  CornerSelector selector;
  GaussianBlur blur;
  PaddedImage blurred;
  Features features;
};

OrbExtractor::OrbExtractor(int width, int height, const OrbOptions& options) : impl_(std::make_unique<Impl>(width, height, options)) {}
OrbExtractor::~OrbExtractor() = default;
OrbExtractor::OrbExtractor(OrbExtractor&&) noexcept = default;
OrbExtractor& OrbExtractor::operator=(OrbExtractor&&) noexcept = default;

const Features& OrbExtractor::extract(ImageView<std::uint8_t> image) {
  impl_->clear();
  if (!impl_->has_size_of(image)) return impl_->features;
  impl_->pyramid.build(image);
  int allowed = 0;
  for (int level = 0; level < impl_->pyramid.num_levels(); ++level) {
    // What a level does not use is left to the coarser ones: a blurred image has its corners there.
    allowed += impl_->share[static_cast<std::size_t>(level)];
    impl_->extract_level(level, allowed - static_cast<int>(impl_->features.size()));
  }
  return impl_->features;
}

void OrbExtractor::copy_patches(std::vector<FeaturePatch>* patches) const {
  static_assert(FeaturePatch::kHalf <= kOrbBorder);
  patches->resize(impl_->features.size());
  for (std::size_t i = 0; i < patches->size(); ++i) {
    const Keypoint& keypoint = impl_->features.keypoints[i];
    const PaddedImage& level = impl_->pyramid.level(keypoint.level);
    const int x = impl_->column_of(keypoint), y = impl_->row_of(keypoint);
    std::uint8_t* out = (*patches)[i].pixels.data();
    for (int dy = -FeaturePatch::kHalf; dy <= FeaturePatch::kHalf; ++dy, out += FeaturePatch::kSide)
      std::copy_n(level.row(y + dy) + x - FeaturePatch::kHalf, FeaturePatch::kSide, out);
  }
}

const Features& OrbExtractor::describe(ImageView<std::uint8_t> image, const std::vector<Keypoint>& keypoints) {
  Impl& impl = *impl_;
  impl.clear();
  if (!impl.has_size_of(image)) return impl.features;
  impl.pyramid.build(image);
  for (const Keypoint& keypoint : keypoints) {
    if (keypoint.level >= impl.pyramid.num_levels()) continue;
    const PaddedImage& level = impl.pyramid.level(keypoint.level);
    const int x = impl.column_of(keypoint), y = impl.row_of(keypoint);
    const bool is_inside = x >= kOrbBorder && y >= kOrbBorder && x < level.width - kOrbBorder && y < level.height - kOrbBorder;
    if (is_inside) impl.features.keypoints.push_back(keypoint);
  }
  impl.features.descriptors.resize(impl.features.keypoints.size());
  for (int level = 0; level < impl.pyramid.num_levels(); ++level) {
    const PaddedImage& level_image = impl.pyramid.level(level);
    impl.blur_level(level_image);
    for (std::size_t i = 0; i < impl.features.size(); ++i) {
      Keypoint& keypoint = impl.features.keypoints[i];
      if (keypoint.level != level) continue;
      impl.features.descriptors[i] = impl.describe_at(level_image, impl.column_of(keypoint), impl.row_of(keypoint), &keypoint);
    }
  }
  return impl.features;
}

const OrbOptions& OrbExtractor::options() const { return impl_->options; }
float OrbExtractor::scale_of_level(int level) const {
  return static_cast<float>(std::pow(static_cast<double>(impl_->options.scale_factor), level));
}
std::uint64_t OrbExtractor::num_clipped() const { return impl_->selector.num_clipped(); }

}  // namespace camloc
