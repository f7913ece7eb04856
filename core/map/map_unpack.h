// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a map file back to values that can be changed: for tools that add a datum, merge maps or export them.
#pragma once

#include "core/map/map_data.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"

namespace camloc {

/// Everything that is in the file, in the order of the file. serialize_map(unpack_map(map), write_options_of(map)) gives the
/// bytes of a file that serialize_map made: each value here is one that has the code in the file, so a view cosine, a
/// direction or a position may differ from what MapView says in its last bit. A keyframe's quaternion is as long as its
/// floats make it, 1 to within 1e-6. A file that is overwritten meanwhile gives wrong values but no wild read; ask
/// MapView::is_damaged afterwards.
[[nodiscard]] MapData unpack_map(const MapView& map);

/// The options the file was written with.
[[nodiscard]] MapWriteOptions write_options_of(const MapView& map);

}  // namespace camloc
