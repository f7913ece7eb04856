// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/calibration_monitor.h"

#include <algorithm>
#include <cmath>

namespace camloc {

void CalibrationMonitor::add(double focal_scale, double sigma) {
  if (!(sigma < numbers_.max_focal_sigma)) return;
  recent_[health_.num_frames % kWindow] = focal_scale;
  ++health_.num_frames;
  std::array<double, kWindow> sorted = recent_;
  const std::uint32_t count = std::min(health_.num_frames, kWindow);
  const auto middle = sorted.begin() + count / 2;
  std::nth_element(sorted.begin(), middle, sorted.begin() + count);
  health_.focal_scale = *middle;
  health_.is_suspect = count >= numbers_.min_focal_frames && std::abs(health_.focal_scale - 1.0) > numbers_.suspect_focal_deviation;
}

}  // namespace camloc
