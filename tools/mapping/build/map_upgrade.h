// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a finished map learns about itself, without a recording: which of its places look alike.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/base/work_observer.h"

namespace camloc::mapping {

struct MapUpgradeSummary {
  std::uint32_t num_keyframes = 0, num_with_rivals = 0;
  std::uint32_t num_landmarks = 0, num_with_twins = 0;
};

/// Finds the look-alikes of the map at `path` and writes it with them to `out_path`, which may be the same; the map stays as it was
/// until the new one is whole. Errors: those of MapView::open and write_map; kIo when `observer` stopped it.
[[nodiscard]] Status upgrade_map(const std::string& path, const std::string& out_path, WorkObserver& observer,
                                 MapUpgradeSummary* summary = nullptr);

}  // namespace camloc::mapping
