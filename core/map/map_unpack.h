// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a map file back to values that can be changed: for tools that add a datum, merge maps or export them.
#pragma once

#include "core/map/map_data.h"
#include "core/map/map_view.h"

namespace camloc {

/// Everything that is in the file, in the order of the file. Writing it again gives the same bytes.
[[nodiscard]] MapData unpack_map(const MapView& map);

}  // namespace camloc
