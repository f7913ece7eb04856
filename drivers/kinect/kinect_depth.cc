// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_depth.h"

#include <algorithm>
#include <cassert>

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

// ---- registration: the fixed-point formats of the coefficients are those of libfreenect_registration.h and of OpenNI2's PS1080.

constexpr double kSubpixels = 256;
constexpr std::uint32_t kColumnBits = 20, kColumnMask = (1U << kColumnBits) - 1;
constexpr std::uint32_t kNowhere = kColumnMask;  // column 4095: no shift brings it back
constexpr double kUsableShare = 0.5;
constexpr double kPixelOrigin = 1;  // the device counts pixels from 1
constexpr double kShiftOffsetPx = 0.375;

/// The low `bits` bits as a signed number.
std::int64_t signed_field(std::int32_t value, int bits) {
  const std::int64_t modulus = std::int64_t{1} << bits;
  const std::int64_t low = value & (modulus - 1);
  return low >= modulus / 2 ? low - modulus : low;
}

/// A polynomial of third degree along a row, advanced by forward differences; each difference has its own scale.
struct RowPolynomial {
  std::int64_t value, first, second;  // in 2^-17 pixels, 2^-11, 2^-3
  std::int64_t third;                 // constant, added to `second`
  [[nodiscard]] double pixels() const { return static_cast<double>(value) / (1 << 17); }
  void step() {
    value += first >> 6;
    first += second >> 8;
    second += third;
  }
};

/// One coordinate of the displacement over the whole image: from row to row the start of RowPolynomial itself moves along
/// polynomials.
struct ImagePolynomial {
  RowPolynomial row;                                    // start of the current row
  std::int64_t value_first, value_second, value_third;  // differences of row.value down the image
  std::int64_t first_first, first_second;               // of row.first
  std::int64_t second_first;                            // of row.second
  void step_down() {
    row.second += second_first;
    row.first += first_first >> 8;
    first_first += first_second;
    row.value += value_first >> 6;
    value_first += value_second >> 8;
    value_second += value_third;
  }
};

ImagePolynomial displacement(const RegistrationAxis& k) {
  return {{signed_field(k.start, 19) * 512, signed_field(k.dx_start, 21) * 256, signed_field(k.dxdx_start, 24) * 256, k.a},
          signed_field(k.dy_start, 21) * 256,
          signed_field(k.dydy_start, 24) * 256,
          k.b,
          signed_field(k.dydx_start, 24) * 256,
          k.d,
          k.c};
}

std::uint32_t place_of(double x, double y, int start_lines) {
  if (!(x >= 0 && y >= 0 && x < kWidth && y < kHeight)) return kNowhere;
  const int row = static_cast<int>(y) - start_lines;
  if (row < 0) return kNowhere;
  return static_cast<std::uint32_t>(row) << kColumnBits | static_cast<std::uint32_t>(x * kSubpixels);
}

// Displacement of a pixel at distance z against one at infinity, towards smaller columns for the near: b f (1/z0 - 1/z).
std::int32_t shift_of(std::uint16_t depth_mm, const ZeroPlane& plane) {
  if (depth_mm == 0) return 0;
  const double baseline_px = plane.color_distance_cm / (2 * plane.pixel_size_cm);  // on the reference plane
  const double reference_mm = 10 * plane.reference_distance_cm;
  const double shift_px = baseline_px * (depth_mm - reference_mm) / depth_mm + kShiftOffsetPx;
  return static_cast<std::int32_t>(std::clamp(shift_px, -1000.0, 1000.0) * kSubpixels);
}

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

std::optional<DepthRegistration> DepthRegistration::create(const KinectCalibration& calibration, const DepthTable& table) {
  if (!calibration.registration || !calibration.zero_plane) return std::nullopt;
  DepthRegistration result;
  result.places_.reserve(static_cast<std::size_t>(kWidth) * kHeight);
  ImagePolynomial dx = displacement(calibration.registration->x), dy = displacement(calibration.registration->y);
  for (int y = 0; y < kHeight; ++y) {
    dx.step_down();
    dy.step_down();
    RowPolynomial dx_row = dx.row, dy_row = dy.row;
    for (int x = 0; x < kWidth; ++x, dx_row.step(), dy_row.step()) {
      result.places_.push_back(
          place_of(x + dx_row.pixels() + kPixelOrigin, y + dy_row.pixels() + kPixelOrigin, calibration.padding_start_lines));
    }
  }
  const auto num_nowhere = static_cast<double>(std::count(result.places_.begin(), result.places_.end(), kNowhere));
  if (num_nowhere > (1 - kUsableShare) * kWidth * kHeight) return std::nullopt;
  result.measurements_.resize(kNumDisparities);
  for (std::size_t raw = 0; raw < kNumDisparities; ++raw)
    result.measurements_[raw] = {shift_of(table[raw], *calibration.zero_plane), table[raw]};
  return result;
}

void DepthRegistration::apply(std::span<const std::uint16_t> raw, Image<std::uint16_t>* millimetres) const {
  assert(raw.size() == places_.size());
  millimetres->resize(kWidth, kHeight);
  std::fill(millimetres->pixels.begin(), millimetres->pixels.end(), std::uint16_t{0});
  std::uint16_t* const out = millimetres->pixels.data();
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const Measurement& measurement = measurements_[raw[i]];
    if (measurement.depth_mm == 0) continue;
    const std::int32_t column = (static_cast<std::int32_t>(places_[i] & kColumnMask) + measurement.shift) >> 8;
    if (static_cast<std::uint32_t>(column) >= static_cast<std::uint32_t>(kWidth)) continue;
    std::uint16_t& target = out[(places_[i] >> kColumnBits) * kWidth + static_cast<std::uint32_t>(column)];
    if (target == 0 || measurement.depth_mm < target) target = measurement.depth_mm;
  }
}

}  // namespace camloc::kinect
