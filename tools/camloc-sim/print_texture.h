// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Printed and man-made detail: posters, signs, sheets, book spines, keyboards, screens, boards, cardboard boxes.
#pragma once

#include "tools/camloc-sim/skin.h"

namespace camloc::sim {

/// As texture_tone, for the materials named above.
[[nodiscard]] float print_tone(const Skin& skin, float u, float v, float width_m, float height_m, float foot_m);

}  // namespace camloc::sim
