// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Does what runs on the device compute what was trained?
#pragma once

#include <span>
#include <string>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "tools/training/trainer.h"

namespace camloc::training {

/// Reads the model file back, runs it as the daemon does and compares it with the trainer's best weights on a few of the views. The largest
/// difference of the seven outputs, relative where they are larger than 1. kNotFound: nothing that runs models is installed; other errors:
/// those of reading and running.
[[nodiscard]] Result<double> compare_with_device(const std::string& model_path, const RgbdCamera& camera, const TrainingSet& set,
                                                 std::span<const std::size_t> views, Trainer* trainer);

}  // namespace camloc::training
