// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What camlocd knows about a frame, as plain values: what every output gets. Units and frames are here; how a message on some wire
// names and packs them is its sink's affair. What it knows about itself is the message camloc.status_t: lcmtypes/status_t.lcm.
#pragma once

#include <cstdint>

#include "core/geometry/wcs.h"
#include "core/localize/localization.h"

namespace camloc {

/// One for every frame, whatever its state.
struct PoseReport {
  Localization localization;          ///< as it came: in the map, with the capture clock's stamp
  std::int64_t capture_epoch_ns = 0;  ///< of the exposure, since the epoch
  std::int64_t age_ns = -1;           ///< from the exposure to now; -1 where the capture clock is not this machine's
  std::uint64_t map_id = 0;           ///< 0 without a map
  const char* parent_frame = "map";   ///< or "wcs"
  /// The camera in the parent frame. Without a pose: identity, with a covariance so large (1e6 m^2, rad^2) that no filter will
  /// believe it.
  PoseWithCovariance T_parent_camera;
  int quality = -1;                 ///< 0..100, -1 without a pose
  std::uint64_t reset_counter = 0;  ///< grows whenever the pose may have jumped
};

/// What a report says beside the localization itself.
struct PoseContext {
  std::uint64_t map_id = 0;
  const WcsDatum* datum = nullptr;  ///< set: poses are reported in `wcs`
  std::uint32_t reset_offset = 0;   ///< resets before the current localizer
  /// Added to a capture stamp it gives nanoseconds since the epoch: 0 for recordings, whose stamps are that by convention.
  std::int64_t stamp_to_epoch_ns = 0;
  std::int64_t now_epoch_ns = 0;
  bool is_capture_clock_ours = true;  ///< false for recordings: their age means nothing
};

[[nodiscard]] PoseReport make_pose_report(const Localization& localization, const PoseContext& context);

}  // namespace camloc
