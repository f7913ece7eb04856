// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Counts heap allocations of the whole process, all threads together, to prove that the daemon makes none per frame.
#pragma once

#include <cstdint>

namespace camloc::testing {

/// False where a sanitizer owns the allocator; tests then skip.
[[nodiscard]] bool can_count_process_allocations();
[[nodiscard]] std::uint64_t num_process_allocations();

}  // namespace camloc::testing
