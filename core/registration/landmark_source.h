// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Landmarks that a view may show, wherever they are kept: in a finished map, in one that SLAM is making, in several maps, in another
// view. A pose is solved against one of these.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/features/matcher.h"
#include "core/geometry/rigid3.h"

namespace camloc {

/// Where landmarks are: enough for a pose from matches that are known already.
class LandmarkPositions {
 public:
  virtual ~LandmarkPositions() = default;
  /// In `map`, metres.
  [[nodiscard]] virtual Eigen::Vector3f position_m(std::int32_t landmark) const = 0;
};

class LandmarkSource : public LandmarkPositions {
 public:
  /// Those that a camera there should see, with windows of this radius. ProjectedLandmark::landmark counts in this source; valid until
  /// the next call.
  [[nodiscard]] virtual std::span<const ProjectedLandmark> project(const Rigid3& T_map_camera, float radius_px) = 0;
  /// What ProjectedLandmark::first_descriptor counts in.
  [[nodiscard]] virtual std::span<const Descriptor> descriptors() const = 0;
  /// Something just like it is known to be elsewhere: it may refine a pose, but says little about the place.
  [[nodiscard]] virtual bool is_repeated(std::int32_t) const { return false; }
};

}  // namespace camloc
