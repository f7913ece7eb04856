// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A localization in which every field is set.
#pragma once

#include "core/localize/localization.h"

namespace camloc::testing {

inline Localization localized() {
  Localization localization;
  localization.sequence = 42;
  localization.stamp_ns = 1'700'000'000'123'456'789;
  localization.state = State::kLocalized;
  localization.reason = Reason::kNone;
  localization.has_pose = true;
  localization.T_map_camera.translation = {1, 2, 3};
  localization.T_map_camera.rotation = exp_so3({0.1, -0.2, 0.3});
  for (int i = 0; i < 36; ++i) localization.covariance(i / 6, i % 6) = i;
  localization.quality = 77;
  localization.integrity_risk = 0.01;
  localization.protection = {{0.03, 0.02}, {0.06, 0.04}};
  localization.num_features = 500;
  localization.evidence.num_matches = 300;
  localization.evidence.num_inliers = 200;
  localization.reset_counter = 2;
  localization.jump_m = 0.5;
  localization.stage_ns = {1000, 2000, 3000, 4000, 5000, 15000};
  return localization;
}

}  // namespace camloc::testing
