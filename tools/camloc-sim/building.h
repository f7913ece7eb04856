// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A plan as surfaces, furniture and light.
#pragma once

#include "tools/camloc-sim/floor_plan.h"

namespace camloc::sim {

/// Builds everything and bakes the light.
[[nodiscard]] Scene build_scene(const FloorPlan& plan, const SceneOptions& options);

}  // namespace camloc::sim
