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

/// A landmark where a pose says that it is, and where the image has it.
struct LandmarkSighting {
  std::uint32_t landmark = 0;
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();      ///< undistorted image coordinates x/z, y/z
  Eigen::Vector2d expected = Eigen::Vector2d::Zero();  ///< the same, of the landmark from the pose
  double sigma = 0;                                    ///< of `seen`, each axis, the same unit
};

struct MotionParallaxOptions {
  std::size_t max_sightings = 1000;         ///< of a frame; further ones are left out
  std::size_t min_shared = 30;              ///< landmarks that two frames must share
  std::int64_t max_age_ns = 5'000'000'000;  ///< an earlier frame is compared with no longer: a slide show is no motion
  double min_evidence = 30.0;               ///< how much likelier the poses must be than a plane, as the logarithm of the ratio
};

/// Compares each frame with an earlier one. Not thread-safe; allocates at construction only; the same input gives the same bits.
class MotionParallax {
 public:
  explicit MotionParallax(const MotionParallaxOptions& options);

  /// Nothing is known.
  void reset();
  /// The sightings of the next frame in which a pose was found; those at one landmark are taken once. They are reordered.
  /// Whether this one and an earlier frame show together that what is seen is no plane.
  [[nodiscard]] bool add(std::int64_t stamp_ns, std::span<LandmarkSighting> sightings);
  /// Of the last add(): the logarithm of how much likelier the poses are than a plane; 0 where too few landmarks are shared.
  [[nodiscard]] double evidence() const { return evidence_; }

 private:
  struct Pair {
    const LandmarkSighting* before;
    const LandmarkSighting* now;
  };
  void find_shared(std::span<const LandmarkSighting> sightings);
  void start_from(std::int64_t stamp_ns, std::span<const LandmarkSighting> sightings);

  MotionParallaxOptions options_;
  std::vector<LandmarkSighting> reference_;  ///< by landmark, each once
  std::int64_t reference_ns_ = 0;
  std::vector<Pair> shared_;
  double evidence_ = 0;
};

}  // namespace camloc
