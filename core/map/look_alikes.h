// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map knows about its own look-alikes: for each keyframe the poses elsewhere from which a camera would see nearly the same, and
// for each landmark how often its like was found elsewhere. A pose that is found at one place is worth nothing before the others that
// explain the same view were asked. Found by core/mapmaking/look_alike_search.h.
// Sattler, Havlena, Schindler and Pollefeys, "Large-scale location recognition and the geometric burstiness problem", 2016.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/map/map_data.h"
#include "core/map/map_view.h"

namespace camloc {

/// Another place from which a keyframe's view can be had.
struct RivalPose {
  std::uint32_t keyframe = 0;  ///< mapped there
  Rigid3 T_map_camera;         ///< where the camera would be
};

/// In `camera`'s axes of the rival keyframe; poses farther than 16 m from it cannot be written and are cut.
[[nodiscard]] map_format::RivalRecord pack_rival(std::uint32_t keyframe, const RivalPose& rival, const Rigid3& T_map_rival_keyframe);

/// Read from a map; keeps a copy of the rivals, and looks twins up in the file. `map` must outlive it.
class LookAlikes {
 public:
  explicit LookAlikes(const MapView& map);
  /// False for a map that was made before camloc looked for them: see `camloc map upgrade`.
  [[nodiscard]] bool is_known() const { return !twins_.empty(); }
  /// Something just like this landmark is elsewhere in the map.
  [[nodiscard]] bool is_repeated(std::uint32_t landmark) const { return landmark < twins_.size() && twins_[landmark] != std::byte{0}; }
  /// How many rivals a keyframe has.
  [[nodiscard]] std::size_t num_rivals(std::uint32_t keyframe) const { return begin_[keyframe + 1] - begin_[keyframe]; }
  /// The most alike first.
  [[nodiscard]] RivalPose rival(std::uint32_t keyframe, std::size_t i) const;

 private:
  const MapView* map_;
  std::span<const std::byte> twins_;
  std::vector<map_format::RivalRecord> records_;
  std::vector<std::uint32_t> begin_;  ///< per keyframe, and the end
};

}  // namespace camloc
