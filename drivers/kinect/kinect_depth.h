// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Raw disparity to millimetres. The device measures against a reference plane; with its own zero plane the distance follows by
// triangulation, without it from a curve that was fitted to many devices.
#pragma once

#include <array>
#include <cstdint>
#include <span>

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

}  // namespace camloc::kinect
