// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which frames of a recording: "start:stop:step[,...]" by Python's slice rules on the frame index.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace camloc {

/// Ascending indices below `num_frames` that `include` (empty = all) names and `exclude` (empty = none) does not.
[[nodiscard]] Result<std::vector<std::size_t>> select_frames(const std::string& include, const std::string& exclude,
                                                             std::size_t num_frames);

}  // namespace camloc
