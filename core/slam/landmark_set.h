// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The landmarks that some keyframes see, side by side in memory, so that they can be projected and matched frame after frame
// without walking through the map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/map/map_data.h"
#include "core/slam/slam_map.h"

namespace camloc {

struct ProjectionLimits {
  double max_range_m = 40.0;
  double max_view_angle_rad = 1.05;  ///< between mean viewing direction and the view
  int level_margin = 1;              ///< pyramid levels beyond those its sightings predict
};

class LandmarkSet {
 public:
  /// Landmarks of the keyframes, in that order, each once, at most `max_landmarks`.
  void assign(const SlamMap& map, std::span<const std::uint32_t> keyframes, std::size_t max_landmarks);
  /// Landmarks of a finished map, with all their descriptors, for a view of the camera `color`. ids are indices in that map.
  void assign(const MapData& map, const Intrinsics& color, std::span<const std::uint32_t> landmarks);
  /// Those in view of a camera there; ProjectedLandmark::landmark is a position in this set. Valid until the next call.
  [[nodiscard]] std::span<const ProjectedLandmark> project(const Rigid3& T_map_camera, float radius_px, const ProjectionLimits& limits);

  [[nodiscard]] std::size_t size() const { return ids_.size(); }
  [[nodiscard]] std::uint32_t id(std::size_t i) const { return ids_[i]; }  ///< index in the map
  [[nodiscard]] const Eigen::Vector3d& position_m(std::size_t i) const { return positions_m_[i]; }
  [[nodiscard]] float angle_rad(std::size_t i) const { return angles_rad_[i]; }
  [[nodiscard]] std::span<const Descriptor> descriptors() const { return descriptors_; }
  [[nodiscard]] std::span<const Descriptor> descriptors_of(std::size_t i) const {
    const std::size_t end = i + 1 < ids_.size() ? first_descriptor_[i + 1] : descriptors_.size();
    return std::span(descriptors_).subspan(first_descriptor_[i], end - first_descriptor_[i]);
  }

 private:
  void clear();

  Intrinsics color_;
  float log_scale_ = 0.18F;
  int num_levels_ = 8;
  std::vector<std::uint32_t> ids_;
  std::vector<Eigen::Vector3d> positions_m_, directions_;
  std::vector<float> log_min_reference_, log_max_reference_, angles_rad_;
  std::vector<Descriptor> descriptors_;
  std::vector<std::uint32_t> first_descriptor_;
  std::vector<ProjectedLandmark> projected_;
};

}  // namespace camloc
