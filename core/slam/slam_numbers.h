// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What SLAM weighs by, where it is worth an experiment: `camloc bench slam --set slam.NAME=VALUE`. The table in slam_numbers.cc
// says what each number decides and what it was measured on. What nobody asks about is a constant where it is used.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/number_table.h"

namespace camloc {

struct SlamNumbers {
  int depth_in_tracking = 1, depth_in_adjustment = 1, close_loops = 1, refine_observations = 1;

  float track_radius_px = 14, track_wide_radius_px = 40;
  std::uint32_t track_min_inliers = 30;
  double track_min_kept_share = 0.5, track_max_speed_m_s = 4.0;
  std::uint32_t found_min_inliers = 45;

  double keyframe_distance = 0.10, keyframe_angle_rad = 0.21, keyframe_share = 0.45;
  std::uint32_t keyframe_inliers = 120;

  int max_lost_views = 10;
  std::uint32_t min_segment_features = 200;

  double bridge_max_length_s = 4.0, bridge_max_sigma_m = 0.25, bridge_max_sigma_rad = 0.10;

  double far_max_distance_m = 40, far_min_parallax_rad = 0.012;

  double loop_drift_m = 0.05, loop_drift_per_m = 0.01;
  double loop_drift_rad = 0.03, loop_drift_rad_per_m = 0.0005, loop_drift_rad_per_rad = 0.01;
  double loop_nearby_m = 1.5, loop_nearby_rad = 0.7;
  int loop_confirmations = 3;
  double loop_max_chi2 = 60;

  std::uint32_t window_free_keyframes = 8, window_fixed_keyframes = 16;
  int window_iterations = 5;
  double window_max_pixel_sigmas = 3.0, final_max_pixel_sigmas = 2.45;

  double pixel_kernel_sigmas = 1.2, depth_kernel_sigmas = 1.3, depth_share = 0.6;
  std::uint32_t max_dense_cameras = 250;
};

/// One line a field.
[[nodiscard]] std::span<const NumberEntry<SlamNumbers>> slam_number_table();

}  // namespace camloc
