// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// ORB features (Rublee et al., 2011) in buffers sized at construction: pyramid, FAST corners, distribution over a grid,
// orientation, smoothing, rotated BRIEF. Pyramid, smoothing, orientation and descriptor equal cv::ORB's, so that
// descriptors of the same keypoints are the same bits; which corners are kept differs (even cover instead of strongest).
#pragma once

#include <vector>

#include "core/base/frame.h"
#include "core/features/corner_selection.h"
#include "core/features/descriptor.h"
#include "core/features/gaussian_blur.h"
#include "core/features/image_pyramid.h"

namespace camloc {

struct OrbOptions {
  int num_features = 1000;  ///< at most; a bound, not a promise
  int num_levels = 8;
  float scale_factor = 1.2F;  ///< between levels
};

/// Not thread-safe. Allocates at construction and never again; work is bounded by image size and num_features.
class OrbExtractor {
 public:
  /// Images given to extract() must have this size.
  OrbExtractor(int width, int height, const OrbOptions& options);
  /// Features of the image, ordered by level, then row, then column. The reference stays valid until the next call.
  /// An image of another size, or too small for one descriptor patch, gives no features.
  const Features& extract(ImageView<std::uint8_t> image);
  /// The pixels around each feature of the last extract(). Resizes `patches` to their number.
  void copy_patches(std::vector<FeaturePatch>* patches) const;

 private:
  void extract_level(int level, int count);

  ImagePyramid pyramid_;
  std::vector<int> share_;  ///< features of each level
  CornerSelector selector_;
  GaussianBlur blur_;
  PaddedImage blurred_;
  Features features_;
};

}  // namespace camloc
