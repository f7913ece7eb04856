// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of SLAM's numbers. A line is added with the field; tests/slam/slam_numbers_test.cc sees that none is missing.
#include "core/slam/slam_numbers.h"

namespace camloc {
namespace {

using N = SlamNumbers;

constexpr NumberEntry<N> kTable[] = {
    {"depth_in_tracking", "0 or 1", &N::depth_in_tracking,
     "measured depth takes part in the pose of a view; without it the synthetic corner is 15.3 cm off instead of 5.9, docs/measured.md"},
    {"depth_in_adjustment", "0 or 1", &N::depth_in_adjustment,
     "and in bundle adjustments, as do links by dense alignment; without: kitchen 6.4 cm instead of 3.6, fr1_rpy 3.4 instead of 1.8"},
    {"close_loops", "0 or 1", &N::close_loops, "places seen again correct the map and join segments"},
    {"refine_observations", "0 or 1", &N::refine_observations,
     "observations move to a fraction of a pixel before the final adjustment; reprojection errors go down by a quarter to two thirds"},

    {"track_radius_px", "px", &N::track_radius_px, "search window around the prediction"},
    {"track_wide_radius_px", "px", &N::track_wide_radius_px, "the same where the narrow one has found too little"},
    {"track_min_inliers", "landmarks", &N::track_min_inliers, "fewer are no pose"},
    {"track_min_kept_share", "share", &N::track_min_kept_share,
     "of the last view's inliers; with fewer, wider searches are tried, too: a radiator fits itself one fin off, the rest does not"},
    {"track_max_speed_m_s", "m/s", &N::track_max_speed_m_s, "a pose that asks for more is refused"},
    {"found_min_inliers", "landmarks", &N::found_min_inliers, "finding back after a loss asks for more than going on"},

    {"keyframe_distance", "share", &N::keyframe_distance, "a keyframe so far from the reference one, of the median depth"},
    {"keyframe_angle_rad", "rad", &N::keyframe_angle_rad, "or turned by so much"},
    {"keyframe_share", "share", &N::keyframe_share,
     "or where the share of features that show landmarks falls below this part of the reference keyframe's"},
    {"keyframe_inliers", "landmarks", &N::keyframe_inliers, "or below so many"},

    {"max_lost_views", "views", &N::max_lost_views, "after so many in a row a new segment begins"},
    {"min_segment_features", "features", &N::min_segment_features, "with depth, that a view needs to begin one, or to end a bridge"},

    {"bridge_max_length_s", "s", &N::bridge_max_length_s, "a longer stretch without features is not bridged"},
    {"bridge_max_sigma_m", "m", &N::bridge_max_sigma_m, "nor one with more doubt, since the last tracked view, in the worst direction"},
    {"bridge_max_sigma_rad", "rad", &N::bridge_max_sigma_rad, "the same of the rotation"},

    {"far_max_distance_m", "m", &N::far_max_distance_m, "of landmarks that are triangulated; 0 = none"},
    {"far_min_parallax_rad", "rad", &N::far_min_parallax_rad, "angle under which such a point sees two cameras"},

    {"loop_drift_m", "m", &N::loop_drift_m, "how far dead reckoning may be off at once"},
    {"loop_drift_per_m", "m/m", &N::loop_drift_per_m, "and more a metre walked"},
    {"loop_drift_rad", "rad", &N::loop_drift_rad, "the same of the rotation"},
    {"loop_drift_rad_per_m", "rad/m", &N::loop_drift_rad_per_m, "and more a metre walked"},
    {"loop_drift_rad_per_rad", "rad/rad", &N::loop_drift_rad_per_rad, "and a radian turned"},
    {"loop_nearby_m", "m", &N::loop_nearby_m, "keyframes so near are asked whether they see the same, whatever the words say"},
    {"loop_nearby_rad", "rad", &N::loop_nearby_rad, "and turned by no more than this"},
    {"loop_confirmations", "keyframes", &N::loop_confirmations, "that must agree where the drift does not explain the correction"},
    {"loop_max_chi2", "", &N::loop_max_chi2, "6 degrees of freedom: a loop that stretches any link of the pose graph farther is refused"},

    {"window_free_keyframes", "keyframes", &N::window_free_keyframes, "that the local adjustment moves"},
    {"window_fixed_keyframes", "keyframes", &N::window_fixed_keyframes, "that hold them in place"},
    {"window_iterations", "", &N::window_iterations, "of the local adjustment"},
    {"window_max_pixel_sigmas", "sigmas", &N::window_max_pixel_sigmas, "observations farther off after it are removed"},
    {"final_max_pixel_sigmas", "sigmas", &N::final_max_pixel_sigmas, "and after the final adjustment"},

    {"pixel_kernel_sigmas", "sigmas", &N::pixel_kernel_sigmas,
     "width of the adjustments' robust kernel; residuals have longer tails than a normal distribution, and most are better than theirs"},
    {"depth_kernel_sigmas", "sigmas", &N::depth_kernel_sigmas, "the same of depth"},
    {"depth_share", "share", &N::depth_share,
     "standard deviation that depth gets, of the scatter that windows show: residuals of pixels in one keyframe go together, those of "
     "depth less. Beside 0.6 of what the camera file says, trajectory error of kitchen 4.1 to 3.6 cm, of the synthetic building 3.6 "
     "to 3.0 cm, of fr1_rpy 1.9 cm both; a tenth of the file's is too much (4.7 cm in the building)"},
    {"max_dense_cameras", "cameras", &N::max_dense_cameras, "free cameras up to which the reduced system is solved dense"},
};

}  // namespace

std::span<const NumberEntry<SlamNumbers>> slam_number_table() { return kTable; }

}  // namespace camloc
