// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The same job done with plain OpenCV calls: cv::ORB, cv::BFMatcher, cv::solvePnPRansac. What anybody would write first.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <optional>

#include "core/base/frame.h"
#include "core/base/stage_timer.h"
#include "core/geometry/camera.h"
#include "core/map/map_landmarks.h"
#include "core/map/map_view.h"

namespace camloc::bench {

struct ReferenceResult {
  std::optional<Rigid3> T_map_camera;
  std::array<std::int64_t, 4> stage_ns{};  ///< extract, match, estimate, total
};

class OpencvReference {
 public:
  /// `is_tracking`: match only landmarks in view from its last pose, else all landmarks of the map.
  OpencvReference(const MapView& map, const RgbdCamera& camera, bool is_tracking, StageTimer::Clock now_ns);
  [[nodiscard]] ReferenceResult process(const Frame& frame);

 private:
  /// Landmarks of the map by the rows of their descriptors.
  struct Descriptors {
    cv::Mat rows;
    std::vector<std::uint32_t> landmarks;
  };
  void add(std::uint32_t landmark, Descriptors* descriptors) const;

  const MapView& map_;
  bool is_tracking_;
  StageTimer::Clock now_ns_;
  cv::Ptr<cv::ORB> orb_;
  cv::BFMatcher matcher_;
  MapLandmarks landmarks_;
  cv::Mat K_, distortion_;
  Descriptors all_, local_;
  std::optional<Rigid3> last_;
};

}  // namespace camloc::bench
