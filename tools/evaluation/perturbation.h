// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What light, exposure, sensor and motion do to an image, applied on purpose: how far does localization hold?
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"

namespace camloc::tools {

/// One change of the grey image. Changes are applied in the order given.
struct Perturbation {
  enum class Kind : std::uint8_t {
    kGamma,     ///< 255 (v / 255)^value
    kContrast,  ///< 128 + value (v - 128)
    kExposure,  ///< value * v
    kNoise,     ///< plus normal noise, sigma = value grey levels, seeded by the frame number
    kBlur,      ///< mean over value pixels along the row: horizontal motion
  };
  Kind kind = Kind::kGamma;
  double value = 1;
};

/// "gamma=0.5", "contrast=0.6", "exposure=0.4", "noise=12", "blur=9".
[[nodiscard]] Result<Perturbation> parse_perturbation(const std::string& text);
void apply(const std::vector<Perturbation>& perturbations, std::uint64_t sequence, Image<std::uint8_t>* gray);

}  // namespace camloc::tools
