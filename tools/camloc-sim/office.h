// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One furnished office.
#pragma once

#include "tools/camloc-sim/floor_plan.h"

namespace camloc::sim {

void add_office(Scene* scene, const Placement& place, const Office& office, const SceneOptions& options);

}  // namespace camloc::sim
