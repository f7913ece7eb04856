// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/localizer_numbers.h"

namespace camloc {
namespace {

using N = LocalizerNumbers;

// kitchen: the Kinect recording of a kitchen, held-out stretches; building: the generated corridors and offices, another day.
constexpr NumberEntry<N> kTable[] = {
    {"num_retrieved", "keyframes", &N::num_retrieved, "looked up by words; many, or the twin of a look-alike is not among them (building)"},
    {"max_places", "places", &N::max_places, "solved a frame, each on its own"},
    {"max_keyframes_per_place", "keyframes", &N::max_keyframes_per_place, "whose landmarks are candidates, at most 16"},
    {"place_radius_m", "m", &N::place_radius_m, "views of one place: camera centres this close"},
    {"place_angle_rad", "rad", &N::place_angle_rad, "and viewing directions"},
    {"max_landmarks", "landmarks", &N::max_landmarks, "projected, the most often observed (time: a fifth of a frame)"},
    {"max_range_m", "m", &N::max_range_m, "of landmarks that are looked for"},
    {"view_angle_margin_rad", "rad", &N::view_angle_margin_rad, "beyond the widest angle a landmark was mapped from"},
    {"ransac_iterations", "samples", &N::ransac_iterations, "of P3P, always all: 0.25 ms with 200 pairs"},
    {"seed", "count", &N::seed, "of the sampling, mixed with the frame's number: another one must make no difference"},
    {"max_ransac_pairs", "pairs", &N::max_ransac_pairs, "best matches by descriptor; worth more than any iteration count (kitchen)"},
    {"max_error_px", "px", &N::max_error_px, "reprojection error of an inlier"},
    {"guided_radius_px", "px", &N::guided_radius_px, "search window of the guided refinement"},
    {"thin_inliers", "inliers", &N::thin_inliers,
     "up to here the matches that a pose leaves over are asked for another one: on a repeated texture they may split (kitchen)"},
    {"rival_distance_m", "m", &N::rival_distance_m, "a pose farther than this from the best is a rival"},
    {"rival_angle_rad", "rad", &N::rival_angle_rad, "or turned by more than this"},
    {"max_rivals", "places", &N::max_rivals, "look-alikes of a place that are asked before it is believed"},
    {"rival_radius_px", "px", &N::rival_radius_px, "search window there"},
    {"min_features", "features", &N::min_features, "fewer: black, white, blurred away"},
    {"min_inliers", "inliers", &N::min_inliers, "of a global fix that measured depth confirms (frames of other places: 16 of 16 had 15)"},
    {"min_inliers_no_depth", "inliers", &N::min_inliers_no_depth, "of a global fix where depth says nothing"},
    {"inliers_per_doubling", "inliers", &N::inliers_per_doubling,
     "more of a global fix for each doubling of the map beyond a room: the more places there are, the more inliers one of them has by "
     "chance (building, 209 cubes: mirrored frames have up to 70, of the right ones 0.7 % have fewer than 100; another building: 97, "
     "though "
     "on a plane; kitchen: right ones from 20)"},
    {"flat_thickness_m", "m", &N::flat_thickness_m, "standard deviation about their plane of inliers that are called flat"},
    {"flat_inliers_factor", "factor", &N::flat_inliers_factor,
     "times as many of a global fix on flat evidence: a panel or a tiled wall is alike in its mirror image and in many places (of 49 "
     "mirrored frames that passed as places of four simulated maps, 26 were flat)"},
    {"flat_found_share", "share", &N::flat_found_share, "unless so many of the landmarks that should be seen are"},
    {"min_found_share", "share", &N::min_found_share,
     "of the landmarks that should be seen and are nowhere else; of a global fix (kitchen: mirrored frames up to 0.012, right ones from "
     "0.016 on)"},
    {"min_tracked_inliers", "inliers", &N::min_tracked_inliers, "where the pose was predicted"},
    {"min_coarse_inliers", "inliers", &N::min_coarse_inliers, "a pose with fewer is not even a coarse place"},
    {"strong_inliers", "inliers", &N::strong_inliers,
     "below, a pose is thin: depth must confirm it and motion expect it; from here on they must only not contradict it (kitchen: depth "
     "that "
     "lags in a fast turn agrees for half of the pixels and the pose is still right)"},
    {"min_inlier_ratio", "share", &N::min_inlier_ratio, "of the matches"},
    {"min_spread", "share", &N::min_spread, "of the image's 8 x 6 cells that hold an inlier"},
    {"min_margin", "share", &N::min_margin, "against the strongest rival that the map does not call a look-alike"},
    {"min_lead", "sigmas", &N::min_lead,
     "by which the features that only a global fix explains outnumber those that only a rival explains (building, other day: wrong ones "
     "lead by up to 5.3; from 6 on 72 % of single frames are fixed)"},
    {"max_wrong_place_risk", "probability", &N::max_wrong_place_risk,
     "at which a place is believed; a lead of min_lead in one view, or a claim that stands for confirmation_s, is worth it"},
    {"new_view_distance_m", "m", &N::new_view_distance_m, "moved by so much the camera has another view, which is evidence of its own"},
    {"new_view_angle_rad", "rad", &N::new_view_angle_rad, "or turned by so much"},
    {"min_depth_samples", "inliers", &N::min_depth_samples, "with depth; fewer say nothing"},
    {"min_depth_agreement", "share", &N::min_depth_agreement, "of the inliers with depth"},
    {"min_depth_agreement_thin", "share", &N::min_depth_agreement_thin, "the same of a thin pose"},
    {"min_map_depth_samples", "landmarks", &N::min_map_depth_samples, "in view on a measured pixel; fewer say nothing"},
    {"min_map_depth_agreement", "share", &N::min_map_depth_agreement, "of the landmarks in view that are not seen through"},
    {"min_map_depth_agreement_thin", "share", &N::min_map_depth_agreement_thin,
     "the same of a thin pose (kitchen: right ones 0.84 and more, half a metre off on a repeated texture 0.64 to 0.75, 1.3 m off 0.17)"},
    {"max_focal_deviation", "share", &N::max_focal_deviation, "of the focal length that the matches ask for"},
    {"focal_deviation_sigmas", "sigmas", &N::focal_deviation_sigmas, "and that many of its standard deviations"},
    {"max_position_sigma_m", "m", &N::max_position_sigma_m, "a pose that is less certain is of no use"},
    {"max_rotation_sigma_rad", "rad", &N::max_rotation_sigma_rad, "the same"},
    {"min_parallax_landmarks", "landmarks", &N::min_parallax_landmarks,
     "that two frames without depth share, to tell a place from a picture"},
    {"min_parallax_evidence", "nats", &N::min_parallax_evidence,
     "by which a place must be likelier than a picture that moves as a plane, before a pose without depth is believed"},
    {"max_speed_m_per_s", "m/s", &N::max_speed_m_per_s, "faster is implausible for a head or a robot indoors"},
    {"max_turn_rad_per_s", "rad/s", &N::max_turn_rad_per_s, "the same"},
    {"speed_change_m_per_s", "m/s", &N::speed_change_m_per_s,
     "standard deviation of the velocity's error, times the time since the last pose"},
    {"turn_change_rad_per_s", "rad/s", &N::turn_change_rad_per_s, "the same"},
    {"expected_sigmas", "sigmas", &N::expected_sigmas, "of prediction and pose together, where motion must expect a pose"},
    {"max_velocity_age_s", "s", &N::max_velocity_age_s, "two poses farther apart say nothing about velocity"},
    {"min_kept_share", "share", &N::min_kept_share,
     "of the last pose's inliers; a thin tracked pose with fewer has the whole map asked, too (synthetic flat: 27 inliers after 302 were "
     "31 cm off)"},
    {"max_tracking_gap_s", "s", &N::max_tracking_gap_s, "without a pose; after it a prediction is no better than a look at the whole map"},
    {"motion_memory_s", "s", &N::motion_memory_s,
     "for so long the last pose limits where the camera can be (building: after a moment without features a stretch that looks alike at "
     "the "
     "other end of the corridor is taken for the real one)"},
    {"confirmation_s", "s", &N::confirmation_s, "a pose that contradicts the motion is believed once it was found for so long"},
    {"max_confirmation_gap_s", "s", &N::max_confirmation_gap_s, "between two of those"},
    {"lost_memory_s", "s", &N::lost_memory_s,
     "for so long after a loss thin evidence is not believed (building: after 5.5 s in a bare corridor nine frames with 30 inliers were "
     "taken "
     "for its twin 50 m away; true returns had 112 and more)"},
    {"ambiguity_memory_s", "s", &N::ambiguity_memory_s,
     "for so long after look-alike places none is believed on thin evidence (building: a bay was taken for its twin 3.6 m along the "
     "corridor "
     "right after two frames that could not tell them apart)"},
    {"suspect_focal_deviation", "share", &N::suspect_focal_deviation, "of the median from 1: a warning"},
    {"min_focal_frames", "frames", &N::min_focal_frames, "before there is one"},
    {"max_focal_sigma", "share", &N::max_focal_sigma, "frames that are less certain take no part"},
};

}  // namespace

std::span<const NumberEntry<LocalizerNumbers>> localizer_number_table() { return kTable; }

}  // namespace camloc
