// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a Kinect knows of its own geometry, as it says it over the wire. Names and meaning: libfreenect_registration.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/camera.h"

namespace camloc::kinect {

/// The devices say 2.3 cm, but their registration blocks belong to this: OpenNI and libfreenect take it for every Kinect.
inline constexpr double kColorDistanceCm = 2.4;

/// Geometry of the reference plane against which disparities are measured.
struct ZeroPlane {
  double emitter_distance_cm = 7.5;             ///< infrared camera to projector
  double color_distance_cm = kColorDistanceCm;  ///< infrared camera to colour camera
  double reference_distance_cm = 120;           ///< of the plane from the infrared camera
  double pixel_size_cm = 0.1042;                ///< on that plane, of a pixel of the sensor, which is 1280 pixels wide
  [[nodiscard]] bool is_plausible() const;
  /// Of the depth image, 640 pixels wide.
  [[nodiscard]] double focal_px() const { return reference_distance_cm / (2 * pixel_size_cm); }
};

/// Coefficients of a polynomial of third degree over the depth image, in fixed point and as forward differences, see
/// kinect_depth.cc.
struct RegistrationAxis {
  std::int32_t a = 0, b = 0, c = 0, d = 0, start = 0;
  std::int32_t dx_start = 0, dy_start = 0, dxdx_start = 0, dydx_start = 0, dydy_start = 0;
};

/// The displacement of a pixel at infinite depth.
struct RegistrationBlock {
  RegistrationAxis x, y;
};

struct KinectCalibration {
  std::optional<ZeroPlane> zero_plane;
  std::optional<RegistrationBlock> registration;
  std::optional<int> const_shift;  ///< disparity of the reference plane, quarter pixels of the depth image times 4
  int padding_start_lines = 0;     ///< rows that the colour image lacks at its top
};

/// From the bodies of the replies (status word first); nullopt where they are too short or hold what no Kinect can mean.
[[nodiscard]] std::optional<ZeroPlane> parse_zero_plane(std::span<const std::uint8_t> body);
[[nodiscard]] std::optional<RegistrationBlock> parse_registration(std::span<const std::uint8_t> body);
[[nodiscard]] std::optional<int> parse_const_shift(std::span<const std::uint8_t> body);
[[nodiscard]] std::optional<int> parse_padding(std::span<const std::uint8_t> body);

inline constexpr std::size_t kZeroPlaneOffset = 94, kZeroPlaneBodyBytes = 322;  ///< 334 bytes on 1473 and K4W
inline constexpr std::size_t kRegistrationBodyBytes = 118, kConstShiftBodyBytes = 4, kPaddingBodyBytes = 8;

/// The pair of cameras for FrameSourceInfo: focal length of the depth camera and distance of the cameras as the device says, the
/// rest as usual for a Kinect (525 px for colour, principal points in the middle, no distortion): good to a few pixels, a
/// calibration is better. With `is_registered` depth pixels are colour pixels. Depth unit 1 mm.
[[nodiscard]] RgbdCamera nominal_camera(const KinectCalibration& calibration, bool is_registered);

}  // namespace camloc::kinect
