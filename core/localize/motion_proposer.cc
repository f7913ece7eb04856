// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/motion_proposer.h"

#include <algorithm>
#include <cmath>

namespace camloc {

std::span<const Proposal> MotionProposer::propose(const ProposerInput& input) {
  const std::optional<Gate::Prediction> predicted = input.gate->predict(input.stamp_ns);
  if (!predicted) return {};
  const double turn_sigma_rad = std::sqrt(predicted->covariance.diagonal().tail<3>().maxCoeff());
  proposal_.T_map_camera = predicted->T_map_camera;
  proposal_.radius_px = static_cast<float>(std::clamp(10.0 + 2.0 * focal_px_ * turn_sigma_rad, 15.0, 0.15 * focal_px_));
  proposal_.is_continuation = true;
  return {&proposal_, 1};
}

}  // namespace camloc
