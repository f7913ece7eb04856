// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From frame to frame: predicts with constant velocity, looks for the landmarks of the neighbouring keyframes, and says when
// a view shows enough that is new to become a keyframe. Poses are kept relative to a keyframe, so that they follow when a
// closed loop moves it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/registration/landmark_set.h"
#include "core/registration/view_registration.h"
#include "core/slam/loops/place_index.h"
#include "core/slam/slam_map.h"

namespace camloc {

struct TrackerOptions {
  std::size_t num_local_keyframes = 16;
  std::size_t max_local_landmarks = 4000;
  float radius_px = 14, wide_radius_px = 40;  ///< search windows around the prediction
  std::uint32_t min_inliers = 30;
  double min_inlier_ratio = 0.3;
  double min_kept_share = 0.5;  ///< of the last view's inliers; with fewer, wider searches are tried, too
  double max_speed_m_s = 4.0;   ///< a pose that asks for more is refused
  double max_gap_s = 0.5;       ///< a longer gap between stamps ends the prediction
  // Finding back after a loss asks for more than going on.
  std::uint32_t min_found_inliers = 45;
  double min_depth_agreement = 0.7, min_spread = 0.12;
  // A keyframe every so often:
  double keyframe_distance = 0.10;  ///< from the reference keyframe, as a share of the median depth
  double keyframe_angle_rad = 0.21;
  double keyframe_share = 0.45;          ///< or when the share of features that show landmarks falls below that of the
                                         ///< reference keyframe times this
  std::uint32_t keyframe_inliers = 120;  ///< or below this many
};

class Tracker {
 public:
  Tracker(const TrackerOptions& options, SlamMap* map, PoseSolver* solver);

  /// Pose of the view near the last one, or not found. Adapts the reference keyframe.
  [[nodiscard]] Registration track(const ViewFeatures& view, std::uint64_t seed);
  /// Pose of the view anywhere in the segment that was tracked last, by what places look like.
  [[nodiscard]] Registration find_back(const ViewFeatures& view, const PlaceIndex& places, std::uint64_t seed);
  [[nodiscard]] bool wants_keyframe(const ViewFeatures& view, const Registration& tracked) const;

  /// The view was accepted with this pose; velocity follows.
  void accept(std::int64_t stamp_ns, const Rigid3& T_map_camera);
  /// Tracking goes on from this keyframe; it was just made of the last view.
  void set_reference(std::uint32_t keyframe);
  /// Keyframes or landmarks were changed by someone else.
  void refresh() { is_local_set_stale_ = true; }
  /// The velocity is not known any more.
  void forget_motion() { velocity_.reset(); }

  /// Where constant velocity leads.
  [[nodiscard]] Rigid3 predict(std::int64_t stamp_ns) const;
  [[nodiscard]] std::uint32_t reference() const { return reference_; }
  [[nodiscard]] Rigid3 T_reference_camera() const { return T_reference_camera_; }

 private:
  struct Velocity {
    Rigid3 T_last_next;  ///< motion over dt_s
    double dt_s = 0;
  };
  void update_local_set();
  [[nodiscard]] bool is_plausible(const Registration& found, std::int64_t stamp_ns) const;
  [[nodiscard]] std::uint32_t best_reference(const Registration& tracked) const;

  TrackerOptions options_;
  SlamMap* map_;
  PoseSolver* solver_;
  LandmarkSet local_, place_;
  bool is_local_set_stale_ = true;
  std::uint32_t reference_ = 0;
  Rigid3 T_reference_camera_;
  std::int64_t last_stamp_ns_ = 0;
  std::uint32_t num_last_inliers_ = 0;
  std::optional<Velocity> velocity_;
};

}  // namespace camloc
