// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes a walk as a TUM RGB-D folder: rgb/, depth/, rgb.txt, depth.txt, groundtruth.txt.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/base/result.h"
#include "tools/camloc-sim/frame_maker.h"

namespace camloc::sim {

struct RecordingOptions {
  double rate_hz = 30;
  double duration_scale = 1;  ///< only this share of the walk
  int num_jobs = 1;           ///< threads; the files do not depend on it
  int jpeg_quality = 92;      ///< 0 writes PNG
  std::int64_t start_ns = 1700000000'000000000;
  FrameMakerOptions frames;
};

/// Called after each frame with frames done and all; from any thread, one at a time.
using Progress = std::function<void(int, int)>;

/// Number of frames written. `folder` must not exist or be empty.
[[nodiscard]] Result<int> record(const World& world, const RgbdCamera& camera, const RecordingOptions& options, const std::string& folder,
                                 const Progress& progress);

}  // namespace camloc::sim
