// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How keyframes lie to each other by all their pixels: each is aligned with some before it. Where features huddle together on
// one poster, they hardly tell a turn from a step to the side, and the error of each keyframe is handed on to the next; the wall
// around the poster tells at once.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/dense/dense_alignment.h"
#include "core/dense/thumbnail.h"
#include "core/optimize/pose_graph.h"
#include "core/slam/slam_map.h"

namespace camloc {

/// Not thread-safe. Holds the thumbnails of a few keyframes.
class DenseLinks {
 public:
  explicit DenseLinks(const RgbdCamera& camera) : aligner_(camera) {}

  /// The keyframe that has just come into the map; returns how many links it got. One without thumbnail gets none.
  int add_keyframe(const SlamMap& map, std::uint32_t keyframe, const Thumbnail& thumbnail);
  /// A link that comes from elsewhere.
  void add(const PoseGraphEdge& link) { links_.push_back(link); }

  [[nodiscard]] std::span<const PoseGraphEdge> links() const { return links_; }

 private:
  struct Recent {
    std::uint32_t keyframe;
    Thumbnail thumbnail;
  };
  DenseAligner aligner_;
  std::deque<Recent> recent_;  ///< the newest at the front
  std::vector<PoseGraphEdge> links_;
};

}  // namespace camloc
