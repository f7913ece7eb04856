// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_calibration.h"

#include <bit>
#include <cmath>

namespace camloc::fakes {
namespace {

constexpr double kSubPixel = 0.375;  // of the sensor's columns
constexpr int kRawPerColumn = 4;

void append_word(std::vector<std::uint8_t>* bytes, std::uint16_t value) {
  bytes->push_back(static_cast<std::uint8_t>(value));
  bytes->push_back(static_cast<std::uint8_t>(value >> 8));
}

void append_long(std::vector<std::uint8_t>* bytes, std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  append_word(bytes, static_cast<std::uint16_t>(bits));
  append_word(bytes, static_cast<std::uint16_t>(bits >> 16));
}

void put_float(std::vector<std::uint8_t>* bytes, std::size_t at, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (std::size_t i = 0; i < 4; ++i) bytes->at(at + i) = static_cast<std::uint8_t>(bits >> (8 * i));
}

}  // namespace

KinectCalibration KinectCalibration::registered(double focal_px) {
  KinectCalibration calibration;
  calibration.color_cm = 0;
  calibration.depth_focal_px = calibration.color_focal_px = focal_px;
  return calibration;
}

double disparity_to_mm(const KinectCalibration& c, int raw) {
  const double column = static_cast<double>(raw - kRawPerColumn * c.const_shift) / kRawPerColumn - kSubPixel;
  const double shift_cm = column * static_cast<double>(c.pixel_cm);
  const double rest_cm = static_cast<double>(c.emitter_cm) - shift_cm;
  if (rest_cm <= 0) return 0;
  return 10 * (static_cast<double>(c.reference_cm) + shift_cm * static_cast<double>(c.reference_cm) / rest_cm);
}

std::uint16_t mm_to_disparity(const KinectCalibration& c, int depth_mm) {
  if (depth_mm <= 0 || depth_mm >= 0xffff) return kNoDisparity;
  // From z = ref + s ref / (e - s): s = e (z - ref) / z.
  const double z_cm = depth_mm / 10.0;
  const double shift_cm = static_cast<double>(c.emitter_cm) * (z_cm - static_cast<double>(c.reference_cm)) / z_cm;
  const double raw = (shift_cm / static_cast<double>(c.pixel_cm) + kSubPixel) * kRawPerColumn + kRawPerColumn * c.const_shift;
  const double low = std::floor(raw);
  if (low < 0 || low + 1 >= kNoDisparity) return kNoDisparity;
  const int floor_raw = static_cast<int>(low);
  // Nearest in depth, not in disparity: they differ where steps are wide.
  const double below = std::abs(disparity_to_mm(c, floor_raw) - depth_mm);
  const double above = disparity_to_mm(c, floor_raw + 1) > 0 ? std::abs(disparity_to_mm(c, floor_raw + 1) - depth_mm) : below;
  return static_cast<std::uint16_t>(below <= above ? floor_raw : floor_raw + 1);
}

std::vector<std::uint16_t> disparity_table(const KinectCalibration& calibration) {
  std::vector<std::uint16_t> table(0x10000);
  for (int mm = 0; mm < 0x10000; ++mm) table[static_cast<std::size_t>(mm)] = mm_to_disparity(calibration, mm);
  return table;
}

std::vector<std::uint8_t> fixed_parameters_block(const KinectCalibration& c, int size) {
  constexpr std::size_t kZeroPlaneAt = 94;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size), 0);
  put_float(&bytes, kZeroPlaneAt, c.emitter_cm);
  put_float(&bytes, kZeroPlaneAt + 4, c.color_cm);
  put_float(&bytes, kZeroPlaneAt + 8, c.reference_cm);
  put_float(&bytes, kZeroPlaneAt + 12, c.pixel_cm);
  return bytes;
}

std::vector<std::uint8_t> registration_block(const KinectCalibration& c) {
  // Displacement of depth pixel (x, y): slope * (x - 320) - parallax_at_infinity; the parallax at depth z, which the reader adds, is
  // color_px * (1 - reference / z). Starts count 1/256 pixel, slopes 2^-15 pixel a pixel. Readers count pixels from 1, add kSubPixel
  // to columns and cut off fractions; the origins below make that the nearest pixel.
  constexpr double kOriginX = 1 + kSubPixel - 0.5, kOriginY = 1 - 0.5;
  const double slope = c.color_focal_px / c.depth_focal_px - 1;
  const double color_px = static_cast<double>(c.color_cm) / (2.0 * static_cast<double>(c.pixel_cm));
  const auto start = [](double px) { return static_cast<std::int32_t>(std::lround(px * 256)); };
  const auto step = [](double px) { return static_cast<std::int32_t>(std::lround(px * 32768)); };
  constexpr int kDxStart = 5, kDyStart = 10, kDxDxStart = 17, kDyDyStart = 20, kNumFields = 29;
  std::vector<std::int32_t> fields(kNumFields, 0);
  fields[kDxStart] = start(-slope * kKinectWidth / 2 - color_px - kOriginX);
  fields[kDyStart] = start(-slope * kKinectHeight / 2 - kOriginY);
  fields[kDxDxStart] = step(slope);
  fields[kDyDyStart] = step(slope);
  std::vector<std::uint8_t> bytes;
  append_word(&bytes, 0);
  for (const std::int32_t field : fields) append_long(&bytes, field);
  return bytes;
}

std::vector<std::uint8_t> padding_block() {
  // Lines at the start, at the end, cropped.
  return {0, 0, 0, 0, 0, 0, 0, 0};
}

std::vector<std::uint8_t> const_shift_block(const KinectCalibration& c) {
  std::vector<std::uint8_t> bytes = {0, 0};
  append_word(&bytes, c.const_shift);
  return bytes;
}

}  // namespace camloc::fakes
