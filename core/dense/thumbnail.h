// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A frame at a glance: grey levels and depth of an RGB-D frame averaged over cells of some pixels. Too coarse for a feature, but a
// bare wall has no other: averages of many pixels show its faint texture and its slope better than any single one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"

namespace camloc {

struct Thumbnail {
  static constexpr int kColumns = 80;  ///< aimed at
  static constexpr float kGreyUnit = 1.0F / 128, kDepthUnitM = 0.00025F;

  int width = 0, height = 0, cell_px = 0;  ///< cells, and pixels of the colour image along the side of one
  std::vector<std::uint16_t> grey;         ///< kGreyUnit grey levels
  /// kDepthUnitM along the optical axis of the colour camera, 0 = none. A mean of 1 / depth, which is linear over the image of a
  /// plane: a mean of depths lies behind it.
  std::vector<std::uint16_t> depth;

  [[nodiscard]] bool empty() const { return grey.empty(); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// Makes thumbnails of frames whose sizes are those of the camera. Depth that is not registered is projected into the colour
/// image, the nearer surface where a cell sees two. Not thread-safe.
class ThumbnailMaker {
 public:
  explicit ThumbnailMaker(const RgbdCamera& camera);
  [[nodiscard]] Thumbnail make(const Frame& frame);

 private:
  struct Sample {
    std::uint32_t cell;
    float z_m;
  };
  void sample_depth(ImageView<std::uint16_t> depth, const Thumbnail& thumbnail);

  RgbdCamera camera_;
  UndistortionTable depth_rays_;
  std::vector<Sample> samples_;
  std::vector<float> nearest_m_, sum_per_m_;
  std::vector<std::uint32_t> counts_;
};

}  // namespace camloc
