// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What SLAM knows while a recording is processed: keyframes with their features, landmarks, and who saw what. A segment is a
// stretch of the recording that hangs together; segments have frames of their own until a place that both saw joins them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/registration/frame_features.h"
#include "core/registration/keypoint_noise.h"
#include "core/registration/landmark_set.h"

namespace camloc {

inline constexpr std::int32_t kNoLandmark = -1;

/// Of a difference between two stamps.
[[nodiscard]] constexpr double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// Feature of a keyframe that shows a landmark.
struct Observation {
  std::uint32_t keyframe = 0, feature = 0;
};

struct SlamLandmark {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< in the frame of its segment
  std::vector<Observation> observations;                 ///< ascending by keyframe, one a keyframe
  Descriptor descriptor;                                 ///< the observation's that is closest to all others
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();   ///< mean unit vector to the cameras that saw it
  float min_reference_m = 0, max_reference_m = 0;        ///< distance * scale of the level it was seen on
  std::int32_t merged_into = kNoLandmark;                ///< gone: it is this one
  [[nodiscard]] bool is_alive() const { return !observations.empty(); }
};

struct SlamKeyframe {
  std::uint64_t frame = 0;  ///< index in the recording
  std::uint32_t segment = 0;
  FrameFeatures view;                             ///< T_map_camera: in the frame of the segment
  std::vector<std::int32_t> landmark_of_feature;  ///< kNoLandmark where there is none
  std::uint32_t num_landmarks = 0;
};

/// A keyframe and how many landmarks it shares with another one.
struct CovisibleKeyframe {
  std::uint32_t keyframe = 0, num_shared = 0;
};

/// Keeps both directions of "who saw what" in step. Not thread-safe; allocates as it goes.
class SlamMap {
 public:
  SlamMap(const RgbdCamera& camera, float scale_factor, int num_levels);

  std::uint32_t add_keyframe(std::uint64_t frame, std::uint32_t segment, FrameFeatures view);
  /// A landmark at the depth of a feature that has one.
  std::uint32_t add_landmark(Observation first);
  /// A landmark that two keyframes see, somewhere.
  std::uint32_t add_landmark(const Eigen::Vector3d& position_m, Observation first, Observation second);
  /// No-op where the keyframe already sees the landmark or the feature already shows one.
  void add_observation(std::uint32_t landmark, Observation observation);
  void remove_observation(std::uint32_t landmark, std::uint32_t keyframe);
  /// `from` becomes `into`; where a keyframe saw both, its observation of `into` stays.
  void merge(std::uint32_t from, std::uint32_t into);
  /// The landmark this one has become after merging, or kNoLandmark when it is gone.
  [[nodiscard]] std::int32_t resolve(std::uint32_t landmark) const;
  /// Descriptor, direction and scale range from the observations; call after these have changed.
  void summarize(std::uint32_t landmark);

  /// Keyframes that share at least `min_shared` landmarks with this one, most first; ties by index.
  [[nodiscard]] std::vector<CovisibleKeyframe> covisible(std::uint32_t keyframe, std::uint32_t min_shared) const;
  /// A keyframe and those that share at least `min_shared` landmarks with it, most first, at most `max_keyframes` in all.
  [[nodiscard]] std::vector<std::uint32_t> surroundings(std::uint32_t keyframe, std::uint32_t min_shared, std::size_t max_keyframes) const;
  [[nodiscard]] LandmarkSet empty_landmark_set() const { return {camera_.color, levels_}; }
  /// Landmarks of the keyframes, in that order, each once, at most `max_landmarks`. ids are indices in this map.
  void collect_landmarks(std::span<const std::uint32_t> keyframes, std::size_t max_landmarks, LandmarkSet* set) const;
  /// Moves all keyframes of a segment, and what they saw, into the frame of another one.
  void join_segments(std::uint32_t from, std::uint32_t into, const Rigid3& T_into_from);

  [[nodiscard]] const RgbdCamera& camera() const { return camera_; }
  [[nodiscard]] const PyramidLevels& levels() const { return levels_; }
  [[nodiscard]] std::span<const SlamKeyframe> keyframes() const { return keyframes_; }
  [[nodiscard]] std::span<const SlamLandmark> landmarks() const { return landmarks_; }
  [[nodiscard]] SlamKeyframe& keyframe(std::uint32_t i) { return keyframes_[i]; }
  [[nodiscard]] const SlamKeyframe& keyframe(std::uint32_t i) const { return keyframes_[i]; }
  [[nodiscard]] const Rigid3& T_map_camera(std::uint32_t keyframe) const { return keyframes_[keyframe].view.T_map_camera; }
  [[nodiscard]] SlamLandmark& landmark(std::uint32_t i) { return landmarks_[i]; }
  [[nodiscard]] const SlamLandmark& landmark(std::uint32_t i) const { return landmarks_[i]; }
  [[nodiscard]] std::uint32_t num_alive_landmarks() const { return num_alive_; }

 private:
  [[nodiscard]] float reference_m(const SlamKeyframe& keyframe, std::uint32_t feature, const Eigen::Vector3d& position_m) const;

  RgbdCamera camera_;
  PyramidLevels levels_;
  std::vector<SlamKeyframe> keyframes_;
  std::vector<SlamLandmark> landmarks_;
  std::uint32_t num_alive_ = 0;
};

}  // namespace camloc
