// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the device knows about its own optics, the blocks in which it tells, and the depth that follows from a raw disparity.
//
// Depth (the public model of the device; see also Khoshelham and Oude Elberink, "Accuracy and Resolution of Kinect Depth Data for
// Indoor Mapping Applications", 2012): the projector's pattern is shifted against the picture of it on a plane at `reference_cm`.
//     shift_cm = ((raw - 4 const_shift) / 4 - 0.375) * pixel_cm        pixel_cm: of the plane, on the sensor's 1280 columns
//     z_cm     = reference_cm + shift_cm * reference_cm / (emitter_cm - shift_cm)
// Depth to colour: polynomials give the displacement in pixels of a depth pixel whose depth is `reference_cm`; parallax is on top.
// Only their constant and linear terms are used here, so that the true geometry is two pinhole cameras.
#pragma once

#include <cstdint>
#include <vector>

namespace camloc::fakes {

inline constexpr int kKinectWidth = 640;
inline constexpr int kKinectHeight = 480;
inline constexpr std::uint16_t kNoDisparity = 2047;  ///< the raw value of a pixel without depth

struct KinectCalibration {
  float emitter_cm = 7.5F;  ///< infrared camera to projector
  float color_cm = 2.3F;    ///< infrared camera to colour camera, along x
  float reference_cm = 120.0F;
  float pixel_cm = 0.1042F;
  std::uint16_t const_shift = 200;
  double depth_focal_px = 585;  ///< of 640x480; centre (320, 240) in both cameras
  double color_focal_px = 525;

  /// One camera sees both: depth that was registered to colour before it came here.
  [[nodiscard]] static KinectCalibration registered(double focal_px);
};

/// Millimetres of a raw disparity; nothing sensible (<= 0) beyond the raw value of infinity.
[[nodiscard]] double disparity_to_mm(const KinectCalibration& calibration, int raw);
/// The raw disparity whose depth is nearest to `depth_mm`; kNoDisparity for 0, 65535 and what the device cannot say. The step from
/// one raw value to the next is 0.5 mm at 0.5 m, 2.8 mm at 1 m, 11 mm at 2 m, 46 mm at 4 m: half of it is the largest error.
[[nodiscard]] std::uint16_t mm_to_disparity(const KinectCalibration& calibration, int depth_mm);
/// mm_to_disparity of every 16-bit depth.
[[nodiscard]] std::vector<std::uint16_t> disparity_table(const KinectCalibration& calibration);

/// Body of the reply to command 0x04 (fixed parameters): `size` bytes, four floats at 94.
[[nodiscard]] std::vector<std::uint8_t> fixed_parameters_block(const KinectCalibration& calibration, int size);
/// Bodies of the replies to command 0x16: registration polynomials (0x40), padding (0x41), constant shift (0x00).
[[nodiscard]] std::vector<std::uint8_t> registration_block(const KinectCalibration& calibration);
[[nodiscard]] std::vector<std::uint8_t> padding_block();
[[nodiscard]] std::vector<std::uint8_t> const_shift_block(const KinectCalibration& calibration);

}  // namespace camloc::fakes
