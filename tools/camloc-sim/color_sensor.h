// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From radiance to the grey image a webcam-like sensor delivers: motion blur over the exposure, lens softness, vignetting,
// exposure, tone curve, noise. The tone curve is a square root, so texture tones come back as grey levels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "tools/camloc-sim/normal_table.h"
#include "tools/camloc-sim/renderer.h"
#include "tools/camloc-sim/trajectory.h"

namespace camloc::sim {

struct Exposure {
  float gain = 1.0F;      ///< radiance times gain: 1 is white
  float time_s = 0.010F;  ///< the shutter is open around the stamp
};

/// Automatic exposure: from the mean tone (square root of radiance) metered before every frame, `interval_s` apart.
[[nodiscard]] std::vector<Exposure> auto_expose(const std::vector<float>& mean_tones, double interval_s);

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

}  // namespace camloc::sim
