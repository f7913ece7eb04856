// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One view as map building sees it: features, where they point, how far they are, and where
// it is asked for the pixels around each. The images are gone after this.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/features/descriptor.h"
#include "core/features/feature_patch.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_registration.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// Features of one view. All vectors have the same length, but for `patches`, which may be empty.
struct ViewFeatures {
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
};

/// Makes views of frames. Not thread-safe.
class ViewExtractor {
 public:
  ViewExtractor(const RgbdCamera& camera, const OrbOptions& orb);

  /// kInvalid when an image size does not fit the camera or there is no depth image; the message names the frame.
  [[nodiscard]] Status check(const Frame& frame) const;
  /// Features of a frame that passed check(), with an unset pose.
  [[nodiscard]] ViewFeatures extract(const Frame& frame);
  /// The same with the pixels around each feature.
  [[nodiscard]] ViewFeatures extract_with_patches(const Frame& frame);

 private:
  RgbdCamera camera_;
  OrbExtractor extractor_;
  UndistortionTable rays_;
  DepthLookup depth_lookup_;
};

}  // namespace camloc
