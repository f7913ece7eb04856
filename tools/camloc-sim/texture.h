// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What surfaces look like: procedural grey textures of paint, carpet, posters, book spines and so on, evaluated at a
// point and filtered to the size of the pixel there, so that they do not shimmer when the camera moves.
#pragma once

#include <cstdint>

namespace camloc::sim {

/// What a face is made of.
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

/// A point (u, v) of a face of width x height, from its lower left corner, and how much of it a pixel there sees; all in metres.
struct Point {
  float u, v, width, height, foot;
};

/// Grey level (0 to 1, as perceived: the square root of reflectance) at the point, averaged over about a pixel.
[[nodiscard]] float texture_tone(const Skin& skin, const Point& p);
/// The same for what is printed or made in detail (posters, books, screens and so on), in print_texture.cc.
[[nodiscard]] float print_tone(const Skin& skin, const Point& p);

/// Shines by itself; the result of texture_tone is then its radiance's square root. Also shiny or transparent to an infrared pattern:
/// a structured-light camera often gets no depth there.
[[nodiscard]] bool is_emissive(Material material);

}  // namespace camloc::sim
