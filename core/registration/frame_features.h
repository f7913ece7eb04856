// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A frame as measurements: its features, where they point, how far they are, and where it is asked for the pixels around each. The
// image is not needed after this.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/features/descriptor.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_registration.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// Features of one frame. All vectors have the same length, but for `patches`, which may be empty.
struct FrameFeatures {
  Rigid3 T_map_camera;
  std::int64_t stamp_ns = 0;
  Features features;
  std::vector<Eigen::Vector2f> normalized;  ///< undistorted image coordinates x/z, y/z
  std::vector<float> depth_m;               ///< along the optical axis, 0 = none
  std::vector<FeaturePatch> patches;        ///< empty where nobody asked for them

  [[nodiscard]] std::size_t size() const { return features.size(); }
  /// Feature i in the camera frame, metres; the origin where it has no depth.
  [[nodiscard]] Eigen::Vector3d point_camera(std::size_t i) const {
    const double z = depth_m[i];
    return {z * normalized[i].x(), z * normalized[i].y(), z};
  }
  void clear();
  void reserve(std::size_t num_features);
};

/// The depth image beside a frame's features, for pixels that are no feature. Empty without one; the image must still be there.
struct MeasuredDepth {
  const DepthLookup* lookup = nullptr;
  ImageView<std::uint16_t> image;

  /// Metres along the optical axis of the colour camera, 0 = none.
  [[nodiscard]] float at(float u, float v) const { return lookup == nullptr ? 0.0F : lookup->depth_at(image, u, v); }
};

/// Makes them of frames. Not thread-safe.
class FrameExtractor {
 public:
  /// Without `use_depth` the depth image is not looked at.
  FrameExtractor(const RgbdCamera& camera, const OrbOptions& orb, bool use_depth = true);

  /// kInvalid when an image size does not fit the camera or there is no depth image; the message names the frame.
  [[nodiscard]] Status check(const Frame& frame) const;
  /// Is there an image, of the camera's size?
  [[nodiscard]] bool has_image(const Frame& frame) const;
  /// Features of a frame that has_image(), with an unset pose. Allocates nothing where `view` has the capacity.
  void extract(const Frame& frame, FrameFeatures* view);
  /// The same with the pixels around each feature.
  [[nodiscard]] FrameFeatures extract_with_patches(const Frame& frame);
  [[nodiscard]] MeasuredDepth depth_of(const Frame& frame) const;

 private:
  RgbdCamera camera_;
  bool use_depth_;
  OrbExtractor extractor_;
  UndistortionTable rays_;
  DepthLookup depth_lookup_;
};

}  // namespace camloc
