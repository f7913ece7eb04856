// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a face is made of.
#pragma once

#include <cstdint>

namespace camloc::sim {

enum class Material : std::uint8_t {
  kPaint,  ///< wall paint: faint mottling and a few scuffs
  kBlank,  ///< a wall without anything to hold on to
  kCarpet,
  kTiles,     ///< floor tiles with speckles
  kLinoleum,  ///< smooth floor, little contrast
  kCeiling,   ///< panels in a grid with pinholes
  kWood,
  kPoster,  ///< layout, shapes and text by seed
  kSign,    ///< plate with a few large glyphs
  kPaper,   ///< sheet of small text
  kBooks,   ///< front of a bookshelf
  kKeyboard,
  kScreen,  ///< lit: ignores the lamps
  kWhiteboard,
  kPinboard,
  kCardboard,
  kRibs,  ///< radiator
  kFabric,
  kCloth,   ///< what people wear
  kLamp,    ///< lit
  kWindow,  ///< lit by the day outside
  kPlain,   ///< uniform plastic or metal
  kBrick,
};

/// One face's looks. The same skin at the same (u, v) looks the same anywhere: look-alike objects share seeds.
struct Skin {
  Material material = Material::kPlain;
  std::uint32_t seed = 0;
  float tone = 0.5F;  ///< mean grey, 0 black to 1 white, as perceived
};

}  // namespace camloc::sim
