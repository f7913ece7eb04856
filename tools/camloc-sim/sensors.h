// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From what an ideal camera sees to what a Kinect delivers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "tools/camloc-sim/noise.h"
#include "tools/camloc-sim/renderer.h"
#include "tools/camloc-sim/trajectory.h"

namespace camloc::sim {

/// The camera everything is rendered with: 640 x 480, f 525 px, registered depth in units of 0.2 mm.
[[nodiscard]] RgbdCamera simulated_camera();

struct Exposure {
  float gain = 1.0F;      ///< radiance times gain: 1 is white
  float time_s = 0.010F;  ///< the shutter is open around the stamp
};

/// Automatic exposure: from the mean tone (square root of radiance) metered before every frame, `interval_s` apart.
[[nodiscard]] std::vector<Exposure> auto_expose(const std::vector<float>& mean_tones, double interval_s);

/// From radiance to the grey image of a webcam-like sensor: motion blur over the exposure, lens softness, vignetting, exposure, tone
/// curve, noise. The tone curve is a square root, so texture tones come back as grey levels.
class ColorSensor {
 public:
  explicit ColorSensor(const Intrinsics& intrinsics);
  /// `is_perfect` leaves out blur, softness, vignetting and noise.
  void expose(const Rendering& rendering, const Trajectory::Twist& twist, const Exposure& exposure, std::uint32_t frame_seed,
              bool is_perfect, Image<std::uint8_t>* gray);

 private:
  void blur_motion(const Rendering& rendering, const Trajectory::Twist& twist, float time_s);
  void soften();

  Intrinsics intrinsics_;
  NormalTable normal_;
  Image<float> vignette_, radiance_, scratch_;
};

/// Structured light seen from a projector 7.5 cm beside the camera. Noise and steps are in disparity, so they grow with z^2
/// (Khoshelham and Elberink, "Accuracy and resolution of Kinect depth data for indoor mapping applications", 2012).
class DepthSensor {
 public:
  /// `is_perfect`: exact depth at every pixel, any range the format holds.
  DepthSensor(const Intrinsics& intrinsics, bool is_perfect) : intrinsics_(intrinsics), is_perfect_(is_perfect) {}
  void measure(const Rendering& rendering, const Renderer& renderer, std::uint32_t frame_seed, Image<std::uint16_t>* depth);

 private:
  void mark_shadows(const Rendering& rendering, int y);

  Intrinsics intrinsics_;
  bool is_perfect_;
  NormalTable normal_;
  std::vector<std::uint8_t> is_shadowed_;  // of one row
};

}  // namespace camloc::sim
