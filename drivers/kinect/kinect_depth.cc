// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See kinect_depth.h.
#include "drivers/kinect/kinect_depth.h"

#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {

namespace {

constexpr double kQuartersPerPixel = 4;  // raw disparities are quarter pixels
constexpr double kPixelOffset = 0.375;   // of the correlation window's centre
constexpr double kMmPerCm = 10;

double triangulated_mm(int raw, const ZeroPlane& plane, int const_shift) {
  const double disparity_px = (raw - kQuartersPerPixel * const_shift) / kQuartersPerPixel - kPixelOffset;
  const double shift_cm = disparity_px * plane.pixel_size_cm;
  return kMmPerCm * (shift_cm * plane.reference_distance_cm / (plane.emitter_distance_cm - shift_cm) + plane.reference_distance_cm);
}

double public_model_mm(int raw) { return 1000.0 / (3.3309495161 - 0.0030711016 * raw); }

}  // namespace

DepthTable make_depth_table(const KinectCalibration& calibration) {
  DepthTable table{};
  const bool is_calibrated = calibration.zero_plane && calibration.const_shift;
  for (int raw = 0; raw < kNoDisparity; ++raw) {
    const double mm = is_calibrated ? triangulated_mm(raw, *calibration.zero_plane, *calibration.const_shift) : public_model_mm(raw);
    // Both curves have a pole, behind which they come back from minus infinity.
    if (mm >= 1 && mm < kMaxDepthMm) table[static_cast<std::size_t>(raw)] = static_cast<std::uint16_t>(mm);
  }
  return table;
}

void convert_depth(std::span<const std::uint16_t> raw, const DepthTable& table, std::uint16_t* millimetres) {
  for (std::size_t i = 0; i < raw.size(); ++i) millimetres[i] = table[raw[i]];
}

}  // namespace camloc::kinect
