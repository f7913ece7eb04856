// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages of a camlocd.
#pragma once

#include <camloc/pose_t.hpp>
#include <camloc/status_t.hpp>

namespace camloc::tools {

inline pose_t make_pose(std::int8_t state) {
  pose_t pose{};
  pose.utime = 1'700'000'000'250'000;
  pose.parent_frame = "map";
  pose.child_frame = "camera";
  pose.state = state;
  pose.pos[0] = 1.5;
  pose.orientation[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = i < 3 ? 1e-4 : 1e-6;
  pose.covariance[7] = 4e-4;  // y: 2 cm
  pose.quality = 80;
  pose.num_matches = 100;
  pose.num_inliers = 60;
  pose.latency_us[5] = 6500;
  pose.age_us = -1;
  pose.map_id = static_cast<std::int64_t>(0xfedcba9876543210ULL);
  return pose;
}

inline status_t make_status() {
  status_t status{};
  status.state = pose_t::LOCALIZED;
  status.state_text = "tracking";
  status.source = "replay://walk";
  status.map_path = "/maps/a.cmap";
  status.focal_scale = 1.17;
  return status;
}

}  // namespace camloc::tools
