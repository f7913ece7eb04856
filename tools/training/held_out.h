// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which frames are kept back. Always stretches: the neighbour of a frame that was shown says nothing about one that was not.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "tools/training/training_set.h"

namespace camloc::training {

struct Split {
  std::vector<std::size_t> shown, held_out;  ///< indices of views
};

/// `stretches`: "start:stop[,...]" of frame numbers of each recording; empty: the last tenth of each. kInvalid: no such text, or nothing is
/// left on one of the sides.
[[nodiscard]] Result<Split> split_views(std::span<const TrainingView> views, const std::string& stretches);

}  // namespace camloc::training
