// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where is this camera in the map? One call per frame, a bounded amount of work, nothing allocated, the same bits for the
// same input.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/frame.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/localize/localization.h"
#include "core/map/map_view.h"

namespace camloc {

struct LocalizerOptions {
  OrbOptions orb;
  bool use_tracking = true;         ///< false: every frame is a kidnapped robot
  bool use_depth = true;
  std::int64_t max_coast_ns = 500'000'000;  ///< COASTING ends this long after the last verified pose
  std::int64_t (*now_ns)() = nullptr;       ///< monotonic clock for stage times; core itself reads none
};

/// Health of the calibration, gathered over frames.
struct CalibrationHealth {
  bool is_suspect = false;      ///< the assumed focal length does not fit the map
  double focal_scale = 1;       ///< true / assumed, median of the recent frames
  std::uint32_t num_frames = 0; ///< that took part
};

/// Not thread-safe. `map` must outlive the localizer. Allocates at construction only.
class Localizer {
 public:
  Localizer(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& options);
  ~Localizer();

  /// The reference stays valid until the next call.
  const Localization& process(const Frame& frame);
  /// Forgets the last pose.
  void reset();
  [[nodiscard]] const CalibrationHealth& calibration() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
