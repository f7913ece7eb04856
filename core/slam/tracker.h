// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From frame to frame: predicts with constant velocity, looks for the landmarks of the neighbouring keyframes, and says when
// a frame shows enough that is new to become a keyframe. Poses are kept relative to a keyframe, so that they follow when a
// closed loop moves it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/registration/frame_registration.h"
#include "core/registration/landmark_set.h"
#include "core/slam/loops/place_index.h"
#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// Landmarks that are looked for around a keyframe, at most.
inline constexpr std::size_t kMaxLocalLandmarks = 4000;

class Tracker {
 public:
  Tracker(const SlamNumbers& numbers, SlamMap* map, PoseSolver* solver);

  /// Pose of the frame near the last one, or not found. Adapts the reference keyframe.
  [[nodiscard]] Registration track(const FrameFeatures& view, std::uint64_t seed);
  /// Pose of the frame anywhere in the segment that was tracked last, by what places look like.
  [[nodiscard]] Registration relocalize(const FrameFeatures& view, const PlaceIndex& places, std::uint64_t seed);
  [[nodiscard]] bool wants_keyframe(const FrameFeatures& view, const Registration& tracked) const;

  /// The frame was accepted with this pose; velocity follows.
  void accept(std::int64_t stamp_ns, const Rigid3& T_map_camera);
  /// Tracking goes on from this keyframe; it was just made of the last frame.
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

  SlamNumbers numbers_;
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
