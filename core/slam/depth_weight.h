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
  /// `share`: standard deviation that the adjustment is given, of the scatter that windows show.
  explicit DepthWeight(double share) : share_(share), scale_(share) {}

  /// An adjustment with weighted() left residuals whose median is this many of its standard deviations.
  void observe(double median_sigmas) {
    if (!(median_sigmas > 0)) return;
    const double scatter = std::clamp(scale_ * median_sigmas / kMedianOfNormal, kMinScatter, kMaxScatter);
    num_observed_ = std::min(num_observed_ + 1, kMemory);
    scatter_ += (scatter - scatter_) / num_observed_;
    scale_ = share_ * scatter_;
  }

  /// The noise of the camera file as the adjustment is to take it.
  [[nodiscard]] DepthNoise weighted(const DepthNoise& of_file) const {
    return {scale_ * of_file.constant_m, scale_ * of_file.quadratic_per_m};
  }

 private:
  static constexpr double kMedianOfNormal = 0.6745;  ///< |x| of a normal distribution, in standard deviations
  static constexpr double kMinScatter = 0.1, kMaxScatter = 1.0;
  static constexpr int kMemory = 20;  ///< windows

  double share_, scatter_ = 1.0, scale_;  ///< in standard deviations of the camera file
  int num_observed_ = 0;
};

}  // namespace camloc
