// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_calibration.h"

#include <algorithm>
#include <bit>

#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {

namespace {

bool is_within(double value, double low, double high) { return value >= low && value <= high; }  // false for NaN

/// Focal length of the colour camera, 640 pixels wide: the value OpenNI and the TUM RGB-D benchmark take for every Kinect.
constexpr double kColorFocalPx = 525.0;

}  // namespace

bool ZeroPlane::is_plausible() const {
  return is_within(emitter_distance_cm, 1, 30) && is_within(color_distance_cm, 0.5, 20) && is_within(reference_distance_cm, 20, 1000) &&
         is_within(pixel_size_cm, 0.01, 2) && is_within(focal_px(), 300, 1200);
}

std::optional<ZeroPlane> parse_zero_plane(std::span<const std::uint8_t> body) {
  if (body.size() < kZeroPlaneOffset + 16) return std::nullopt;
  const auto number = [body](std::size_t index) {
    return static_cast<double>(std::bit_cast<float>(double_word_at(body, kZeroPlaneOffset + 4 * index)));
  };
  ZeroPlane plane{number(0), number(1), number(2), number(3)};
  if (!plane.is_plausible()) return std::nullopt;
  plane.color_distance_cm = kColorDistanceCm;
  return plane;
}

std::optional<RegistrationBlock> parse_registration(std::span<const std::uint8_t> body) {
  if (body.size() < kRegistrationBodyBytes) return std::nullopt;
  // A device without calibration answers with zeros.
  if (std::all_of(body.begin() + 2, body.begin() + kRegistrationBodyBytes, [](std::uint8_t byte) { return byte == 0; }))
    return std::nullopt;
  const auto number = [body](std::size_t index) { return static_cast<std::int32_t>(double_word_at(body, 2 + 4 * index)); };
  return RegistrationBlock{
      {number(1), number(2), number(3), number(4), number(5), number(17), number(19), number(21), number(22), number(26)},
      {number(6), number(7), number(8), number(9), number(10), number(18), number(20), number(23), number(24), number(28)}};
}

std::optional<int> parse_const_shift(std::span<const std::uint8_t> body) {
  if (body.size() < kConstShiftBodyBytes) return std::nullopt;
  const int shift = word_at(body, 2);
  if (shift < 50 || shift > 500) return std::nullopt;
  return shift;
}

std::optional<int> parse_padding(std::span<const std::uint8_t> body) {
  if (body.size() < kPaddingBodyBytes) return std::nullopt;
  const int start_lines = word_at(body, 2);
  if (start_lines >= kHeight / 4) return std::nullopt;
  return start_lines;
}

RgbdCamera nominal_camera(const KinectCalibration& calibration, bool is_registered) {
  const ZeroPlane plane = calibration.zero_plane.value_or(ZeroPlane{});
  RgbdCamera camera;
  camera.name = "kinect";
  camera.color.width = kWidth;
  camera.color.height = kHeight;
  camera.color.fx = camera.color.fy = kColorFocalPx;
  camera.color.cx = 0.5 * (kWidth - 1);
  camera.color.cy = 0.5 * (kHeight - 1);
  camera.depth = camera.color;
  camera.is_depth_registered = is_registered;
  if (!is_registered) {
    camera.depth.fx = camera.depth.fy = plane.focal_px();
    camera.T_color_depth.translation.x() = -0.01 * plane.color_distance_cm;  // the colour camera is to the right of the infrared one
  }
  camera.min_depth_m = 0.4;
  camera.max_depth_m = 8.0;
  return camera;
}

}  // namespace camloc::kinect
