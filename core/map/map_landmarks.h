// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The landmarks of a finished map, to register views to. Walks the cubes that the view frustum touches, nearest first, so the cost
// follows what is in view and not the size of the map.
#pragma once

#include <span>
#include <vector>

#include "core/map/look_alikes.h"
#include "core/map/map_view.h"
#include "core/registration/landmark_source.h"
#include "core/registration/projection.h"

namespace camloc {

struct MapLandmarksOptions {
  int max_landmarks = 3000;  ///< handed out at most; the most often observed are kept
  int max_cubes = 64;        ///< visited at most
  int max_visited = 60000;   ///< landmarks looked at, at most
  ProjectionLimits limits;
};

/// Not thread-safe; allocates at construction only. `map` and `look_alikes`, where given, must outlive it.
class MapLandmarks final : public LandmarkSource {
 public:
  MapLandmarks(const MapView& map, const Intrinsics& color, const MapLandmarksOptions& options, const LookAlikes* look_alikes = nullptr);
  [[nodiscard]] std::span<const ProjectedLandmark> project(const Rigid3& T_map_camera, float radius_px) override;
  [[nodiscard]] std::span<const Descriptor> descriptors() const override { return map_->descriptors(); }
  [[nodiscard]] Eigen::Vector3f position_m(std::int32_t landmark) const override {
    return map_->position_m(static_cast<std::uint32_t>(landmark));
  }
  [[nodiscard]] bool is_repeated(std::int32_t landmark) const override {
    return look_alikes_ != nullptr && look_alikes_->is_repeated(static_cast<std::uint32_t>(landmark));
  }

 private:
  void collect_cubes(const Rigid3& T_camera_map);
  void project_cube(const map_format::CubeRecord& cube);
  void keep_most_observed();

  const MapView* map_;
  const LookAlikes* look_alikes_;
  MapLandmarksOptions options_;
  LandmarkProjector projector_;
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
