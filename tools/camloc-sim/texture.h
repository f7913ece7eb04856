// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What surfaces look like: procedural grey textures of paint, carpet, posters, book spines and so on, evaluated at a
// point and filtered to the size of the pixel there, so that they do not shimmer when the camera moves.
#pragma once

#include "tools/camloc-sim/skin.h"

namespace camloc::sim {

/// Grey level (0 to 1, as perceived: the square root of reflectance) at (u, v) metres from the lower left corner of a face
/// of width x height metres, averaged over about foot_m metres.
[[nodiscard]] float texture_tone(const Skin& skin, float u, float v, float width_m, float height_m, float foot_m);

/// Shines by itself; the result of texture_tone is then its radiance's square root.
[[nodiscard]] bool is_emissive(Material material);
/// Shiny or transparent to an infrared pattern: a structured-light camera often gets no depth there.
[[nodiscard]] bool is_depth_unfriendly(Material material);

}  // namespace camloc::sim
