// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// ORB features (Rublee et al., 2011) in buffers sized at construction: pyramid, FAST corners, distribution over a grid,
// orientation, smoothing, rotated BRIEF. Pyramid, smoothing, orientation and descriptor equal cv::ORB's, so that
// descriptors of the same keypoints are the same bits; which corners are kept differs (even cover instead of strongest).
#pragma once

#include <memory>
#include <vector>

#include "core/base/frame.h"
#include "core/features/descriptor.h"
#include "core/features/feature_patch.h"

namespace camloc {

struct OrbOptions {
  int num_features = 1000;  ///< at most; a bound, not a promise
  int num_levels = 8;
  float scale_factor = 1.2F;  ///< between levels
  int fast_threshold = 20;    ///< grey levels; where a cell has no such corner, min_fast_threshold is tried
  int min_fast_threshold = 7;
  int cell_px = 32;  ///< side of a grid cell on each level
};

/// Not thread-safe. Allocates at construction and never again; work is bounded by image size and num_features.
class OrbExtractor {
 public:
  /// Images given to extract() must have this size.
  OrbExtractor(int width, int height, const OrbOptions& options);
  ~OrbExtractor();
  OrbExtractor(OrbExtractor&&) noexcept;
  OrbExtractor& operator=(OrbExtractor&&) noexcept;

  /// Features of the image, ordered by level, then row, then column. The reference stays valid until the next call.
  /// An image of another size, or too small for one descriptor patch, gives no features.
  const Features& extract(ImageView<std::uint8_t> image);
  /// The pixels around each feature of the last extract(). Resizes `patches` to their number.
  void copy_patches(std::vector<FeaturePatch>* patches) const;

  /// Orientation and descriptor for given keypoints (u, v, level are read; angle is set) of the image: for tests
  /// against cv::ORB and for tools. Keypoints closer than 19 px (of their level) to the border are dropped.
  const Features& describe(ImageView<std::uint8_t> image, const std::vector<Keypoint>& keypoints);

  [[nodiscard]] const OrbOptions& options() const;
  [[nodiscard]] float scale_of_level(int level) const;  ///< scale_factor ^ level
  /// Corners that were found but not kept because a buffer was full, since construction.
  [[nodiscard]] std::uint64_t num_clipped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
