// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How many metres a unit of a structure-from-motion model is: images alone do not tell, the depth that was recorded with
// them does.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/base/result.h"

namespace camloc::mapping {

/// A point of the model as one image sees it.
struct DepthPair {
  std::uint32_t image = 0;      ///< which; numbers are only compared
  double model_depth = 0;       ///< along the optical axis, units of the model, > 0
  double measured_depth_m = 0;  ///< by the depth camera at the same pixel, > 0
};

struct ModelScale {
  double metres_per_unit = 1;
  double spread = 0;        ///< of single ratios, one robust standard deviation, relative
  double image_spread = 0;  ///< the same of the images' medians: drift of scale within the model
  std::uint64_t num_pairs = 0, num_images = 0;
};

/// "0.271 m a unit, from 80170 points in 60 images; scatter 1.2 %, drift between images 0.4 %": for a summary.
[[nodiscard]] std::string describe_scale(const ModelScale& scale);

/// Median of measured / model depth. The spreads are 1.4826 times the median absolute deviation of the logarithm of the ratio.
/// kInvalid, naming the numbers: too few pairs, or spreads above the limits, as with poses, images or a depth that do not
/// belong together.
[[nodiscard]] Result<ModelScale> estimate_model_scale(std::span<const DepthPair> pairs);

}  // namespace camloc::mapping
