// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which landmarks are worth their bytes: those that many views see, spread evenly over the views and over each image, so
// that every mapped view keeps its share. The value of a selection is the sum over all (view, image cell) of the square
// root of the number of selected landmarks there: submodular, so the greedy choice is within 1 - 1/e of the best
// (Nemhauser, Wolsey, Fisher, "An analysis of approximations for maximizing submodular set functions", 1978).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mapmaking/landmark_fusion.h"

namespace camloc {

/// Indices of the landmarks to keep, ascending; at most `max_landmarks`, 0 = no limit. Landmarks that one view alone sees are
/// taken only for views that have few others. `worth` may say for each landmark how many observations those in `views` stand
/// for, where the views are a choice themselves; empty: each for itself.
[[nodiscard]] std::vector<std::uint32_t> select_landmarks(std::span<const std::vector<ViewObservation>> views, std::size_t num_landmarks,
                                                          std::uint32_t max_landmarks, std::span<const float> worth = {});

}  // namespace camloc
