// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which landmarks should a camera at a given pose see, and where in the image? Walks the cubes that the view frustum
// touches, nearest first, so the cost follows what is in view and not the size of the map.
#pragma once

#include <span>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/map/map_view.h"

namespace camloc {

struct LocalLandmarksOptions {
  int max_landmarks = 3000;  ///< projected at most; the most often observed are kept
  int max_cubes = 64;        ///< visited at most
  int max_visited = 60000;   ///< landmarks looked at, at most
  double max_range_m = 8.0;
  double view_angle_margin_rad = 0.5;  ///< beyond the widest angle it was mapped from
  int level_margin = 1;                ///< pyramid levels beyond those its mapping predicts
};

/// Not thread-safe; allocates at construction only.
class LocalLandmarks {
 public:
  LocalLandmarks(const MapView& map, const Intrinsics& color, const LocalLandmarksOptions& options);
  /// Landmarks inside the image for that pose; valid until the next call.
  std::span<const ProjectedLandmark> project(const Rigid3& T_map_camera, float radius_px);

 private:
  void collect_cubes(const Rigid3& T_camera_map);
  void project_cube(const map_format::CubeRecord& cube, const Rigid3& T_map_camera, float radius_px);
  void keep_most_observed();

  const MapView* map_;
  Intrinsics color_;
  LocalLandmarksOptions options_;
  float inverse_log_scale_;
  std::vector<float> log_reference_;  ///< per 8-bit code
  struct NearCube {
    float distance_m;
    std::uint32_t index;
  };
  std::vector<NearCube> cubes_;
  std::vector<ProjectedLandmark> projected_;
  std::vector<std::uint8_t> num_observations_;  ///< parallel to projected_
  int num_visited_ = 0;
};

}  // namespace camloc
