// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Watches the focal length that frame after frame asks for. The map is metric and so is measured depth, so a wrong focal
// length shows; peers localize half a metre off without a word.
#pragma once

#include <array>
#include <cstdint>

#include "core/localize/localization.h"
#include "core/localize/localizer_numbers.h"

namespace camloc {

class CalibrationMonitor {
 public:
  explicit CalibrationMonitor(const LocalizerNumbers& numbers) : numbers_(numbers) {}
  void add(double focal_scale, double sigma);
  [[nodiscard]] const CalibrationHealth& health() const { return health_; }

 private:
  static constexpr std::uint32_t kWindow = 31;
  LocalizerNumbers numbers_;
  std::array<double, kWindow> recent_{};
  CalibrationHealth health_;
};

}  // namespace camloc
