// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two maps become one file: what `camloc map merge` and `camloc map build --extend` do once both maps are there.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/merge/map_merging.h"

namespace camloc::mapping {

struct MergeSummary {
  std::string map_a, map_b;  ///< b: a map file or the recording it was made from
  std::string map_path;      ///< of the result
  MapMergeReport report;
  double seconds = 0;
};

/// kIo: the user ended the work on the map at that path, which is as it was.
[[nodiscard]] Status interrupted(const std::string& map_path);

/// Merges `b` into the map at `map_a` and writes the result to `map_path`, which may be `map_a` itself: it is replaced by a
/// complete map or stays as it is. Errors: those of MapView::open, merge_maps and
/// write_map, kInvalid when the maps do not fit, interrupted() when `observer` said so.
[[nodiscard]] Status merge_into(const std::string& map_a, const MapData& b, const MapMergeOptions& options, const std::string& map_path,
                                WorkObserver& observer, MergeSummary* summary);

/// Rows of a table, and the same as JSON.
[[nodiscard]] std::string format_table(const MergeSummary& summary);
[[nodiscard]] std::string format_json(const MergeSummary& summary);

}  // namespace camloc::mapping
