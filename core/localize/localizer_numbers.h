// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Everything the localizer weighs by, with its defaults. Units, meaning and where each was measured stand in the table in
// localizer_numbers.cc; an experiment sets them with --set localizer.NAME=VALUE.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/number_table.h"

namespace camloc {

struct LocalizerNumbers {
  // Places to look at.
  int num_retrieved = 80;
  int max_places = 6;
  int max_keyframes_per_place = 6;
  double place_radius_m = 2.0;
  double place_angle_rad = 1.2;
  // The pose among landmarks.
  int max_landmarks = 3000;
  double max_range_m = 8.0;
  double view_angle_margin_rad = 0.5;
  int ransac_iterations = 600;
  std::uint32_t seed = 0;
  int max_ransac_pairs = 300;
  double max_error_px = 5.0;
  float guided_radius_px = 12.0F;
  std::uint32_t thin_inliers = 80;
  double rival_distance_m = 0.25;
  double rival_angle_rad = 0.2;
  int max_rivals = 10;
  double rival_radius_px = 30.0;
  // Verification.
  std::uint32_t min_features = 40;
  std::uint32_t min_inliers = 20;
  std::uint32_t min_inliers_no_depth = 40;
  double inliers_per_doubling = 9.0;
  double flat_thickness_m = 0.025;
  double flat_inliers_factor = 2.0;
  double flat_found_share = 0.1;
  double min_found_share = 0.015;
  std::uint32_t min_tracked_inliers = 15;
  std::uint32_t min_coarse_inliers = 15;
  std::uint32_t strong_inliers = 60;
  double min_inlier_ratio = 0.4;
  double min_spread = 0.1;
  double min_margin = 0.4;
  double min_lead = 6.0;
  double max_wrong_place_risk = 0.001;
  double new_view_distance_m = 0.5;
  double new_view_angle_rad = 0.35;
  std::uint32_t min_depth_samples = 12;
  double min_depth_agreement = 0.4;
  double min_depth_agreement_thin = 0.6;
  std::uint32_t min_map_depth_samples = 30;
  double min_map_depth_agreement = 0.5;
  double min_map_depth_agreement_thin = 0.8;
  double max_focal_deviation = 0.05;
  double focal_deviation_sigmas = 4.0;
  double max_position_sigma_m = 0.15;
  double max_rotation_sigma_rad = 0.06;
  std::uint32_t min_parallax_landmarks = 30;
  double min_parallax_evidence = 15.0;
  // Motion and memory.
  double max_speed_m_per_s = 3.0;
  double max_turn_rad_per_s = 7.0;
  double speed_change_m_per_s = 0.4;
  double turn_change_rad_per_s = 0.5;
  double expected_sigmas = 3.0;
  double max_velocity_age_s = 0.5;
  double min_kept_share = 0.5;
  double max_tracking_gap_s = 1.0;
  double motion_memory_s = 5.0;
  double confirmation_s = 1.0;
  double max_confirmation_gap_s = 0.5;
  double lost_memory_s = 60.0;
  double ambiguity_memory_s = 1.0;
  // Calibration.
  double suspect_focal_deviation = 0.035;
  std::uint32_t min_focal_frames = 8;
  double max_focal_sigma = 0.03;
};

[[nodiscard]] std::span<const NumberEntry<LocalizerNumbers>> localizer_number_table();

}  // namespace camloc
