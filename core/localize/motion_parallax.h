// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A place, or a picture of it? Where depth is not measured a photograph of a mapped room gives as good a pose as the room. What gives
// it away is motion: whichever way the camera goes, a picture moves in the image as a plane, by a homography (Hartley and Zisserman,
// "Multiple View Geometry in Computer Vision", 2004, ch. 13), and a room does not. A wall without anything before it is as flat as its
// picture and shows nothing either way.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"

namespace camloc {

/// A landmark where the image has it.
struct LandmarkSighting {
  std::uint32_t landmark = 0;
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();  ///< undistorted image coordinates x/z, y/z
  double depth_m = 0;                              ///< along the optical axis, from the pose: what the map says
  double sigma = 0;                                ///< of `seen`, each axis, the same unit
};

struct MotionParallaxOptions {
  std::size_t max_sightings = 1000;  ///< of a frame; further ones are left out
  std::size_t min_shared = 30;       ///< landmarks that two frames must share
  /// An earlier frame is compared with no longer: a slide show is no motion.
  std::int64_t max_age_ns = 5'000'000'000;
  double min_evidence = 15.0;  ///< how much likelier a place must be than a picture, as the logarithm of the ratio
};

/// Compares each frame with an earlier one. Not thread-safe; allocates at construction only; the same input gives the same bits.
class MotionParallax {
 public:
  explicit MotionParallax(const MotionParallaxOptions& options);

  /// Nothing is known.
  void reset();
  /// The next frame in which a pose was found; of several sightings of one landmark one is taken, and they are reordered.
  /// Whether the frames so far show that what is seen is no picture.
  [[nodiscard]] bool add(std::int64_t stamp_ns, const Rigid3& T_map_camera, std::span<LandmarkSighting> sightings);
  /// The logarithm of how much likelier a place is than a picture, by all frames since the last reset().
  [[nodiscard]] double evidence() const { return earlier_evidence_ + evidence_; }

 private:
  struct Pair {
    const LandmarkSighting* before;
    const LandmarkSighting* now;
  };
  void find_shared(std::span<const LandmarkSighting> sightings);
  void start_from(std::int64_t stamp_ns, const Rigid3& T_map_camera, std::span<const LandmarkSighting> sightings);
  [[nodiscard]] double compare(const Rigid3& T_before_now) const;

  MotionParallaxOptions options_;
  std::vector<LandmarkSighting> reference_;  ///< by landmark, each once
  std::int64_t reference_ns_ = 0;
  Rigid3 T_map_reference_;
  std::vector<Pair> shared_;
  double evidence_ = 0;          ///< of the last frame against the reference
  double earlier_evidence_ = 0;  ///< of those before it, each against the last frame that shared enough with it
};

}  // namespace camloc
