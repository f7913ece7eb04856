// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth into the pixels of the colour camera, from the parameters that the device carries. Where a depth pixel lands is a fixed
// displacement (two polynomials of third degree over the image, for lenses and rotation) and a shift along the row that depends
// on the distance (the two cameras stand side by side).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "drivers/kinect/kinect_calibration.h"
#include "drivers/kinect/kinect_depth.h"

namespace camloc::kinect {

/// Thread-safe once made; allocates at creation only (1.3 MB).
class DepthRegistration {
 public:
  /// nullopt: the device gave no registration block or no zero plane, or the block sends most pixels out of the image.
  [[nodiscard]] static std::optional<DepthRegistration> create(const KinectCalibration& calibration, const DepthTable& table);

  /// `raw` are the 640x480 disparities (below kNumDisparities) of the depth camera; `millimetres` becomes 640x480 in the pixels
  /// of the colour camera, 0 where no depth landed; the nearer surface wins.
  void apply(std::span<const std::uint16_t> raw, Image<std::uint16_t>* millimetres) const;

 private:
  struct Measurement {
    std::int32_t shift = 0;  ///< along the row, 256ths of a pixel
    std::uint16_t depth_mm = 0;
  };
  DepthRegistration() = default;

  std::vector<std::uint32_t> places_;      ///< of every depth pixel at infinity: row << 20 | column in 256ths
  std::vector<Measurement> measurements_;  ///< of every raw value
};

}  // namespace camloc::kinect
