// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Parts of the SLAM map as bundle problems, and their solutions back into the map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/optimize/bundle_adjustment.h"
#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"

namespace camloc {

/// A surveyed point that keyframes see. It is no landmark of the map: nobody finds it by its looks.
struct ControlLandmark {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< as surveyed, in the frame of the segment
  double sigma_m = 0.01;
  struct Seen {
    std::uint32_t keyframe = 0;
    float x = 0, y = 0;  ///< normalized image coordinates
    float depth_m = 0;   ///< 0 = none
    float sigma_px = 1;
  };
  std::vector<Seen> seen;
};

/// What is known about the keyframes of a map besides their observations.
struct MapEvidence {
  std::span<const ControlLandmark> controls;
  std::span<const PoseGraphEdge> links;  ///< between keyframes, e.g. by dense alignment
};

/// A bundle problem and which part of the map each of its unknowns is.
struct MapExtract {
  static constexpr std::uint32_t kAbsent = 0xFFFFFFFF;

  BundleProblem problem;
  std::vector<std::uint32_t> keyframes, landmarks;  ///< index in the map of each camera and landmark
  std::vector<std::uint32_t> camera_of_keyframe;    ///< kAbsent where it takes no part
};

/// The keyframe and its best neighbours, what they see, and fixed, other keyframes that see it.
[[nodiscard]] MapExtract extract_window(const SlamNumbers& numbers, std::uint32_t keyframe, const SlamMap& map);

/// All keyframes of a segment, the first one fixed, with what they see and what else is known about them. With three or more
/// control landmarks none is fixed. Links count as much less as they disagree with the map in their median: their covariances
/// know nothing of a depth camera that is bent or not in step with the colour camera.
[[nodiscard]] MapExtract extract_segment(std::uint32_t segment, const MapEvidence& evidence, const SlamMap& map);

/// Poses and landmarks back into the map. A landmark with a single observation stays where its keyframe sees it.
void write_back(const MapExtract& extract, SlamMap* map);

}  // namespace camloc
