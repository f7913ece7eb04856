// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The same job done with plain OpenCV calls: cv::ORB, cv::BFMatcher, cv::solvePnPRansac. What anybody would write first.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/frame.h"
#include "core/base/stage_timer.h"
#include "core/geometry/camera.h"
#include "core/map/map_view.h"

namespace camloc::bench {

struct ReferenceOptions {
  int num_features = 1000;
  int ransac_iterations = 600;
  double max_error_px = 5.0;
  double max_ratio = 0.8;
  std::size_t min_inliers = 15;
  bool is_tracking = false;  ///< match only landmarks in view from its last pose, else all landmarks of the map
};

struct ReferenceResult {
  std::optional<Rigid3> T_map_camera;
  std::int64_t extract_ns = 0, match_ns = 0, estimate_ns = 0;
  [[nodiscard]] std::int64_t total_ns() const { return extract_ns + match_ns + estimate_ns; }
};

class OpencvReference {
 public:
  OpencvReference(const MapView& map, const RgbdCamera& camera, const ReferenceOptions& options, StageTimer::Clock now_ns);
  ~OpencvReference();
  [[nodiscard]] ReferenceResult process(const Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc::bench
