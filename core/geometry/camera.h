// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Camera models: points in front of the camera to pixels and back. Pixel centres are at integers, as in OpenCV. A model
// holds no image and allocates nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/rigid3.h"

namespace camloc {

enum class LensModel : std::uint8_t {
  kPinhole,       ///< no distortion
  kBrownConrady,  ///< k1 k2 p1 p2 k3 (Brown, "Decentering distortion of lenses", 1966; OpenCV's order)
  kEquidistant,   ///< k1 k2 k3 k4 (Kannala and Brandt, "A generic camera model and calibration method ...", 2006)
  kRational,      ///< k1 k2 p1 p2 k3 k4 k5 k6: radial (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6); OpenCV's order
                  ///< (Claus and Fitzgibbon, "A rational function lens distortion model ...", 2005)
};

/// Intrinsics of one camera together with the image size they belong to.
struct Intrinsics {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0;  ///< focal lengths, pixels
  double cx = 0, cy = 0;  ///< principal point, pixels
  LensModel lens = LensModel::kPinhole;
  std::array<double, 8> distortion{};  ///< see LensModel; unused entries are zero

  /// Finite, positive focal lengths, principal point not absurdly far outside the image, size 1 to 16384.
  [[nodiscard]] Status validate() const;
  [[nodiscard]] double mean_focal_px() const { return 0.5 * (fx + fy); }

  /// Point in the camera frame (metres, z > 0) to pixel.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const;
  /// Normalized image coordinates (x/z, y/z) to pixel: applies distortion.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& normalized) const;
  /// Pixel to normalized image coordinates: removes distortion by Newton iteration, at most 10 steps. Returns the best
  /// guess even where the model is not invertible; use `is_invertible_at` to ask.
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] bool is_invertible_at(const Eigen::Vector2d& pixel) const;
};

/// Distance noise of a structured-light depth camera: sigma(z) = constant_m + quadratic_per_m * z^2, metres
/// (Khoshelham and Elberink, "Accuracy and resolution of Kinect depth data ...", 2012).
struct DepthNoise {
  double constant_m = 0.001;
  double quadratic_per_m = 0.006;
  [[nodiscard]] double sigma_m(double z_m) const { return constant_m + quadratic_per_m * z_m * z_m; }
};

/// A colour and a depth camera on one rigid mount, and how to read the depth image.
struct RgbdCamera {
  std::string name;
  Intrinsics color;
  Intrinsics depth;                 ///< equals `color` where depth is registered
  Rigid3 T_color_depth;             ///< p_color = T_color_depth * p_depth
  bool is_depth_registered = true;  ///< depth pixel (u, v) belongs to colour pixel (u, v)
  double depth_unit_m = 0.001;      ///< metres per raw depth unit
  double min_depth_m = 0.3;
  double max_depth_m = 8.0;
  DepthNoise depth_noise;
  bool poses_are_of_depth_camera = false;  ///< recorded poses belong to the depth camera (7-Scenes)

  [[nodiscard]] Status validate() const;
  /// Metres, or 0 where the raw value is invalid (0, 65535) or out of range.
  [[nodiscard]] float depth_m(std::uint16_t raw) const {
    if (raw == 0 || raw == 65535) return 0.0F;
    const double z = raw * depth_unit_m;
    return z < min_depth_m || z > max_depth_m ? 0.0F : static_cast<float>(z);
  }
};

/// Undistortion of many pixels: bilinear look-up in a table built once. Exact at the nodes, every `step_px` pixels; between
/// them at most 0.04 px off for TUM fr1 and 0.12 px for a 140 degree lens, both in the extreme corner (mean 0.003, 0.03).
/// A ray at 90 degrees or more to the optical axis has no normalized coordinates and is cut off just below.
class UndistortionTable {
 public:
  explicit UndistortionTable(const Intrinsics& intrinsics, int step_px = 8);
  [[nodiscard]] Eigen::Vector2f undistort(float u, float v) const;

 private:
  int columns_ = 0, rows_ = 0;
  float inverse_step_ = 1;
  std::vector<Eigen::Vector2f> nodes_;
};

}  // namespace camloc
