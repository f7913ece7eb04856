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

struct MapWriteOptions {
  double cube_m = 4.0;  ///< side of a cube; 4 m give positions of 0.06 mm
};

/// The bytes of the file. Landmarks are reordered by cube; keyframe lists follow. Deterministic. A camera name of more
/// than 63 bytes is cut.
/// Errors: kInvalid when the data contradict themselves (index out of range, no descriptor, non-finite, no landmark).
[[nodiscard]] Result<std::vector<std::byte>> serialize_map(const MapData& map, const MapWriteOptions& options = {});

/// Errors: those of serialize_map, and kIo (disk full, permission), after which `path` is untouched.
[[nodiscard]] Status write_map(const MapData& map, const std::string& path, const MapWriteOptions& options = {});

}  // namespace camloc
