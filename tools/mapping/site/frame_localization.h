// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Single frames of a recording, localized in a finished map, with the depth at the pixels that somebody picked in them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/map/map_view.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {

/// What one frame had to say. Errors are reasons for people.
struct LocalizedFrame {
  Result<PoseWithCovariance> T_map_camera = Status(ErrorCode::kNotFound, "the recording has no such frame, or it cannot be read");
  PixelMeasurements measurements;
};

/// Localizes the frames that `observations` have pixels in. A few frames before each are run through the localizer too, so
/// that it may track. Errors are those of opening the recording, kInvalid where its images are not the camera's, kIo where `observer` wants
/// to stop.
[[nodiscard]] Result<std::map<std::uint64_t, LocalizedFrame>> localize_frames(const MapView& map, const RgbdCamera& camera,
                                                                              const std::string& sequence_url,
                                                                              const std::vector<ControlObservation>& observations,
                                                                              const WorkObserver& observer);

}  // namespace camloc::mapping
