// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From exact depth to what a Kinect delivers: structured light seen from a projector 7.5 cm beside the camera. Noise and
// steps are in disparity, so they grow with z^2 (Khoshelham and Elberink, "Accuracy and resolution of Kinect depth data for
// indoor mapping applications", 2012).
#pragma once

#include <cstdint>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "tools/camloc-sim/normal_table.h"
#include "tools/camloc-sim/renderer.h"

namespace camloc::sim {

struct DepthSensorOptions {
  bool is_perfect = false;    ///< exact depth at every pixel, any range the format holds
  double unit_m = 0.0002;     ///< metres per raw unit: TUM's factor 5000
  double baseline_m = 0.075;  ///< camera to projector
  double focal_px = 580;      ///< of the infrared camera
  double disparity_step_px = 0.125;
  double noise_per_m = 0.0015;  ///< sigma of depth before the steps is noise_per_m * z^2
  double min_m = 0.5, max_m = 5.0;
};

/// Noise of the whole sensor, steps included: what a user of the data should assume.
[[nodiscard]] DepthNoise expected_noise(const DepthSensorOptions& options);

class DepthSensor {
 public:
  DepthSensor(const Intrinsics& intrinsics, const DepthSensorOptions& options) : intrinsics_(intrinsics), options_(options) {}
  void measure(const Rendering& rendering, const Renderer& renderer, std::uint32_t frame_seed, Image<std::uint16_t>* depth);

 private:
  void measure_exactly(const Rendering& rendering, Image<std::uint16_t>* depth) const;
  void mark_shadows(const Rendering& rendering, int y);

  Intrinsics intrinsics_;
  DepthSensorOptions options_;
  NormalTable normal_;
  std::vector<std::uint8_t> is_shadowed_;  // of one row
};

}  // namespace camloc::sim
