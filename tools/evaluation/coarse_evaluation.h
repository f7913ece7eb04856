// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far off are the answers to "roughly where is this?": of a neural network, of retrieval by words, and of both together. Nothing
// here is verified: that is the localizer's part.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/coarse/coarse_network.h"
#include "core/map/retrieval.h"
#include "core/registration/frame_features.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {

struct CoarseErrors {
  std::uint64_t num_answers = 0;
  ErrorStatistics translation_m, rotation_deg;
};

struct CoarseReport {
  std::uint64_t num_frames = 0;  ///< that have a true pose
  CoarseErrors cnn, retrieval, both;
  double nees_mean = 0, nees_median = 0;        ///< of the network's error model: 6 and 5.35 when honest
  double locate_p50_ms = 0, locate_p99_ms = 0;  ///< of the network, one frame on one core
};

/// One of both, without knowing the truth: the view that retrieval found, unless its score is weak; then the pose in the middle between
/// that and the network's.
[[nodiscard]] Rigid3 merge_coarse(const CoarsePose& cnn, const RankedKeyframe& best, const MapView& map);

/// Not thread-safe. `map` must outlive it.
class CoarseEvaluation {
 public:
  CoarseEvaluation(const MapView& map, const RgbdCamera& camera, CoarseNetwork network);
  /// A frame with its true pose in the map.
  void add(const Frame& frame, const Rigid3& T_map_camera_true);
  [[nodiscard]] CoarseReport report() const;

 private:
  struct Errors {
    std::vector<double> translation_m, rotation_deg;
    void add(const Rigid3& reference, const Rigid3& estimate);
    [[nodiscard]] CoarseErrors summarize() const;
  };
  const MapView* map_;
  CoarseNetwork network_;
  FrameExtractor extractor_;
  FrameFeatures view_;
  Retriever retriever_;
  std::uint64_t num_frames_ = 0;
  Errors cnn_, retrieval_, both_;
  std::vector<double> nees_, milliseconds_;
};

}  // namespace camloc::tools
