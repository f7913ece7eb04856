// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Counts heap allocations of the calling thread, to prove that frame-path code makes none.
#pragma once

#include <cstdint>

namespace camloc::testing {

/// False where a sanitizer owns the allocator; tests then skip.
[[nodiscard]] bool can_count_allocations();
/// Allocations by this thread since it started.
[[nodiscard]] std::uint64_t num_allocations();

}  // namespace camloc::testing
