// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where else a camera could be that seems to be here: the look-alikes that the map knows of the keyframes nearby.
#pragma once

#include <span>
#include <vector>

#include "core/localize/localizer_numbers.h"
#include "core/map/look_alikes.h"

namespace camloc {

/// Not thread-safe; allocates at construction only. `map` must outlive it.
class RivalPoses {
 public:
  RivalPoses(const MapView& map, const LocalizerNumbers& numbers);
  /// T_map_camera at each look-alike place, at most capacity() of them, those of the nearest keyframe first. Valid until the next call.
  [[nodiscard]] std::span<const Rigid3> of(const Rigid3& T_map_camera);
  [[nodiscard]] std::size_t capacity() const { return poses_.capacity(); }
  [[nodiscard]] const LookAlikes& look_alikes() const { return look_alikes_; }

 private:
  struct NearKeyframe {
    double distance = 0;
    std::uint32_t keyframe = 0;
  };
  void add(const Rigid3& T_map_camera);

  const MapView* map_;
  LookAlikes look_alikes_;
  std::vector<NearKeyframe> near_;
  std::vector<Rigid3> poses_;
};

}  // namespace camloc
