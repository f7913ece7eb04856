// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How a training went, as a picture: the loss, and the errors on held-out frames, epoch by epoch.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "tools/training/trainer.h"

namespace camloc::training {

/// Writes a PNG.
[[nodiscard]] Status write_learning_curves(std::span<const EpochRecord> epochs, std::optional<std::size_t> best_epoch,
                                           const std::string& path);

}  // namespace camloc::training
