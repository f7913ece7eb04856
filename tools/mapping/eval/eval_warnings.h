// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What to be careful about in an evaluation.
#pragma once

#include <string>
#include <vector>

#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {

/// One line each, that begins with a word in capitals: SCALE, VOLUME, POINTS, START, OVERLAP, SLIDING, ICP.
[[nodiscard]] std::vector<std::string> warnings_of(const Evaluation& evaluation);

}  // namespace camloc::mapping
