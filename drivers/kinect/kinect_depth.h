// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Raw disparity to millimetres. The device measures against a reference plane; with its own zero plane the distance follows by
// triangulation, without it from a curve that was fitted to many devices.
//
// And depth into the pixels of the colour camera, from the parameters that the device carries. Where a depth pixel lands is a fixed
// displacement (two polynomials of third degree over the image, for lenses and rotation) and a shift along the row that depends
// on the distance (the two cameras stand side by side).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "drivers/kinect/kinect_calibration.h"

namespace camloc::kinect {

inline constexpr std::size_t kNumDisparities = 2048;
/// Millimetres for every raw value of 11 bits, 0 where there is no measurement or it is not from 1 mm to kMaxDepthMm.
using DepthTable = std::array<std::uint16_t, kNumDisparities>;
inline constexpr double kMaxDepthMm = 10'000;

/// With zero plane and constant shift, both from the device: disparity d in pixels of the wide sensor against the reference
/// plane, z = z0 + z0 x / (b - x) with x = d * pixel size, b the distance of camera and projector (Khoshelham and Elberink,
/// "Accuracy and resolution of Kinect depth data for indoor mapping applications", 2012, give the geometry; units and constants
/// as libfreenect takes them). Otherwise 1 / (3.33095 - 0.00307110 raw) metres (OpenKinect wiki, "Imaging Information").
[[nodiscard]] DepthTable make_depth_table(const KinectCalibration& calibration);

/// Millimetres of a whole image; raw values are below kNumDisparities.
void convert_depth(std::span<const std::uint16_t> raw, const DepthTable& table, std::uint16_t* millimetres);

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
