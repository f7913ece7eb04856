// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Packs a MapData into a .cmap file. The old file stays whole until the new one is complete on disk: temporary file in
// the same folder, fsync, rename.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/map/map_data.h"

namespace camloc {

/// The bytes of the file. Landmarks are reordered by sub-map; keyframe lists follow. Deterministic.
/// Errors: kInvalid when the data contradict themselves (index out of range, no descriptor, non-finite, empty).
[[nodiscard]] Result<std::vector<std::byte>> serialize_map(const MapData& map);

/// Errors: those of serialize_map, and kIo (disk full, permission), after which `path` is untouched.
[[nodiscard]] Status write_map(const MapData& map, const std::string& path);

}  // namespace camloc
