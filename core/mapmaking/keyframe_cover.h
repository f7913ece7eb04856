// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keyframes: the fewest views that together see all landmarks. Exact minimum set cover is NP-hard; the greedy choice is
// within ln(n) + 1 of it, and no polynomial algorithm does better in general (Chvatal, "A greedy heuristic for the
// set-covering problem", 1979; Feige, "A threshold of ln n for approximating set cover", 1998).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace camloc {

struct KeyframeCover {
  std::vector<std::uint32_t> views;      ///< chosen, ascending
  std::vector<std::uint32_t> uncovered;  ///< items in no chosen view, ascending
};

/// `items_of_view[v]` lists the items (below `num_items`, each at most once) that view v sees. Views are taken while they
/// add at least `min_gain` items; ties go to the lower index; chosen views that later ones made superfluous are removed.
/// With min_gain = 1 everything that is in some view is covered.
[[nodiscard]] KeyframeCover cover_with_keyframes(std::span<const std::vector<std::uint32_t>> items_of_view, std::size_t num_items,
                                                 std::uint32_t min_gain = 1);

}  // namespace camloc
