// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Counts what the calling thread allocates with new, but for OpenNI2's library, which allocates for every frame.
#pragma once

#include <cstdint>

namespace camloc::testing {

/// False where a sanitizer owns the allocator; tests then skip.
[[nodiscard]] bool can_count_thread_allocations();
[[nodiscard]] std::uint64_t num_thread_allocations();

}  // namespace camloc::testing
