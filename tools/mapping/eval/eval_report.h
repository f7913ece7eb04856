// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What an evaluation says: a table for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {

struct EvalSummary {
  std::string map_path, cloud_name;
  std::uint64_t num_read = 0, num_invalid = 0, num_points = 0;  ///< of the cloud
  double voxel_m = 0;
  std::uint32_t min_observations = 0;
  Evaluation evaluation;
  std::vector<std::string> files;  ///< that were written
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const EvalSummary& summary);
[[nodiscard]] std::string format_json(const EvalSummary& summary);

/// What to be careful about: one line each, that begins with a word in capitals: SCALE, VOLUME, POINTS, START, OVERLAP, SLIDING, ICP.
[[nodiscard]] std::vector<std::string> warnings_of(const Evaluation& evaluation);

}  // namespace camloc::mapping
