// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How much the measured depth counts beside the pixels in a bundle adjustment. The depth noise of a camera file says how far a
// single look may be off, and files differ: some have the scatter that was measured, some add the bias and the edges. What the
// adjusted windows leave over tells what this camera really does, so its standard deviation is estimated from them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/optimize/bundle_adjustment.h"

namespace camloc {

class DepthWeight {
 public:
  /// An adjustment with options() left residuals whose median is this many of its standard deviations.
  void observe(double median_sigmas) {
    if (!(median_sigmas > 0)) return;
    const double scatter = std::clamp(scale_ * median_sigmas / kMedianOfNormal, kMinScatter, kMaxScatter);
    num_observed_ = std::min(num_observed_ + 1, kMemory);
    scatter_ += (scatter - scatter_) / num_observed_;
    scale_ = kShare * scatter_;
  }

  /// The noise of the camera file as the adjustment is to take it.
  [[nodiscard]] DepthNoise weighted(const DepthNoise& of_file) const {
    return {scale_ * of_file.constant_m, scale_ * of_file.quadratic_per_m};
  }

 private:
  static constexpr double kMedianOfNormal = 0.6745;  ///< |x| of a normal distribution, in standard deviations
  static constexpr double kMinScatter = 0.1, kMaxScatter = 1.0;
  static constexpr int kMemory = 20;  ///< windows
  // Residuals of pixels in one keyframe go together, and so do those of a landmark that was registered to one view; those of
  // depth go together less, and deserve more than their scatter says. Measured beside 0.6 of what the file says: trajectory error of
  // kitchen 4.1 to 3.6 cm, of the synthetic building 3.6 to 3.0 cm, of fr1_rpy 1.9 cm both; a tenth of the file's is too much (4.7 cm
  // in the building).
  static constexpr double kShare = 0.6;

  double scatter_ = 1.0, scale_ = kShare;  ///< in standard deviations of the camera file
  int num_observed_ = 0;
};

}  // namespace camloc
