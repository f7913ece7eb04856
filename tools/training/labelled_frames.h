// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The frames of a recording, each with the pose that a network shall learn for it.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/map/map_view.h"
#include "tools/training/training_set.h"

namespace camloc::training {

struct RecordingRequest {
  std::string map_path, camera_path;
  std::string sequence;
  std::string poses;            ///< "embedded" or a TUM file, in the frame of the map; empty: the map says, frame by frame
  std::string frames, exclude;  ///< Python slices
};

struct LabelCounts {
  std::uint64_t num_labelled = 0;
  std::uint64_t num_unlabelled = 0;  ///< without a pose, not localized, or broken
};

/// Reads the recording once. Errors: those of reading recording, poses, map and camera; kIo: `observer` stopped it.
[[nodiscard]] Result<LabelCounts> add_recording(const RecordingRequest& request, const RgbdCamera& camera, std::uint32_t recording,
                                                WorkObserver* observer, TrainingSet* set);

}  // namespace camloc::training
