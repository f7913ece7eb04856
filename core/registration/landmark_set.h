// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A few thousand landmarks of some place, side by side in memory, so that they can be projected and matched again and again without
// walking through the map they are from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/registration/landmark_source.h"
#include "core/registration/projection.h"

namespace camloc {

class LandmarkSet final : public LandmarkSource {
 public:
  LandmarkSet(const Intrinsics& color, const PyramidLevels& levels);

  struct Entry {
    std::uint32_t id = 0;  ///< index in the map it is from
    Eigen::Vector3d position_m, direction;
    float min_reference_m = 0, max_reference_m = 0, angle_rad = 0;
    std::span<const Descriptor> descriptors;
  };
  void clear();
  void add(const Entry& landmark);

  [[nodiscard]] std::span<const ProjectedLandmark> project(const Rigid3& T_map_camera, float radius_px) override;
  [[nodiscard]] std::span<const Descriptor> descriptors() const override { return descriptors_; }
  [[nodiscard]] Eigen::Vector3f position_m(std::int32_t i) const override { return landmarks_[static_cast<std::size_t>(i)].position_m; }
  /// All descriptors, as candidates for a match without a prediction; as many as there is room for.
  void append_candidates(CandidateSet* candidates) const;

  [[nodiscard]] std::size_t size() const { return landmarks_.size(); }
  [[nodiscard]] std::uint32_t id(std::size_t i) const { return landmarks_[i].id; }

 private:
  struct Landmark {
    std::uint32_t id;
    Eigen::Vector3f position_m, direction;
    float log_min_reference, log_max_reference, angle_rad;
    std::uint32_t first_descriptor, num_descriptors;
  };
  LandmarkProjector projector_;
  std::vector<Landmark> landmarks_;
  std::vector<Descriptor> descriptors_;
  std::vector<ProjectedLandmark> projected_;
};

}  // namespace camloc
