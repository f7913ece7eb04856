// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The textures of building surfaces and furniture. Printed matter is in print_texture.cc.
#include "tools/camloc-sim/texture.h"

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

/// Dark or bright specks, one candidate per cell of `cell_m`, present with the given probability.
float specks(const Point& p, float cell_m, float probability, float min_radius_m, float max_radius_m, std::uint32_t seed) {
  if (p.foot > cell_m) return 0.0F;
  const int i = floor_int(p.u / cell_m), j = floor_int(p.v / cell_m);
  const std::uint32_t h = hash_cell(i, j, seed);
  if (unit(h) >= probability) return 0.0F;
  const float radius = range(hash32(h, 1), min_radius_m, max_radius_m);
  const float margin = std::min(0.5F, radius / cell_m);
  const float cu = (static_cast<float>(i) + range(hash32(h, 2), margin, 1 - margin)) * cell_m;
  const float cv = (static_cast<float>(j) + range(hash32(h, 3), margin, 1 - margin)) * cell_m;
  const float stretch = range(hash32(h, 4), 0.4F, 1.0F);
  const float ink = covered_disc(p.u * stretch + cu * (1 - stretch), p.v, cu, cv, radius, p.foot);
  return ink * std::min(1.0F, radius / p.foot) * range(hash32(h, 5), 0.4F, 1.0F);
}

float paint(const Skin& s, const Point& p) {
  const float mottle =
      0.025F * octaves(p.u, p.v, 0.8F, 2, 0.6F, s.seed, p.foot) + 0.020F * octaves(p.u, p.v, 0.04F, 2, 0.7F, s.seed + 7, p.foot);
  const float low = clamp01(1.0F - p.v / 0.9F);  // feet, chairs and trolleys leave their marks low on the wall
  const float scuff = specks(p, 0.30F, 0.10F + 0.35F * low, 0.004F, 0.02F, s.seed + 11);
  return s.tone + mottle - 0.22F * scuff;
}

float carpet(const Skin& s, const Point& p) {
  return s.tone + 0.05F * octaves(p.u, p.v, 1.4F, 1, 0.6F, s.seed, p.foot) +
         0.13F * octaves(p.u, p.v, 0.06F, 4, 0.75F, s.seed + 3, p.foot) - 0.20F * specks(p, 0.22F, 0.3F, 0.006F, 0.02F, s.seed + 5);
}

float tiles(const Skin& s, const Point& p) {
  constexpr float kTile = 0.4F;
  const float tile = filtered_lattice(p.u / kTile, p.v / kTile, p.foot / kTile, 0.0F,
                                      [&](int i, int j) { return range(hash_cell(i, j, s.seed), -0.05F, 0.05F); });
  const float grout = std::max(covered_lines(p.u, kTile, 0.008F, p.foot), covered_lines(p.v, kTile, 0.008F, p.foot));
  const float grain = 0.07F * octaves(p.u, p.v, 0.04F, 3, 0.8F, s.seed + 3, p.foot);
  return mix(s.tone + tile + grain - 0.25F * specks(p, 0.08F, 0.35F, 0.004F, 0.013F, s.seed + 9), s.tone - 0.28F, grout);
}

float ceiling(const Skin& s, const Point& p) {
  constexpr float kPanel = 0.6F;
  const float panel = filtered_lattice(p.u / kPanel, p.v / kPanel, p.foot / kPanel, 0.0F,
                                       [&](int i, int j) { return range(hash_cell(i, j, s.seed), -0.025F, 0.025F); });
  const float bar = std::max(covered_lines(p.u, kPanel, 0.024F, p.foot), covered_lines(p.v, kPanel, 0.024F, p.foot));
  const float holes = specks(p, 0.06F, 0.55F, 0.003F, 0.009F, s.seed + 5);
  return mix(s.tone + panel + 0.03F * octaves(p.u, p.v, 0.05F, 2, 0.7F, s.seed + 2, p.foot) - 0.30F * holes, s.tone - 0.16F, bar);
}

float wood(const Skin& s, const Point& p) {
  const float bend = 0.03F * value_noise(p.u / 0.5F, p.v / 0.15F, s.seed + 1);
  const float grain = octaves(p.u * 0.08F, p.v + bend, 0.03F, 4, 0.7F, s.seed, p.foot);
  const float knots = specks(p, 0.45F, 0.35F, 0.008F, 0.022F, s.seed + 4);
  return s.tone + 0.09F * grain - 0.22F * knots;
}

float ribs(const Skin& s, const Point& p) {
  const float phase = p.u / 0.05F;
  const float wave = std::sin(6.2831853F * phase) * resolved(0.05F, p.foot);
  return s.tone + 0.13F * wave - 0.2F * covered_lines(p.v, 0.56F, 0.02F, p.foot);
}

float fabric(const Skin& s, const Point& p) {
  return s.tone + 0.07F * octaves(p.u, p.v, 0.04F, 4, 0.8F, s.seed, p.foot) + 0.06F * octaves(p.u, p.v, 0.3F, 2, 0.5F, s.seed + 1, p.foot);
}

float cloth(const Skin& s, const Point& p) {
  const float folds = octaves(p.u * 2.0F, p.v, 0.25F, 3, 0.6F, s.seed, p.foot);
  const float stripes = s.seed % 3U == 0U ? covered_lines(p.v, 0.09F, 0.035F, p.foot) : 0.0F;
  return s.tone + 0.10F * folds + 0.16F * stripes;
}

float window(const Skin& s, const Point& p) {
  const float horizon = p.height * range(hash32(s.seed, 1), 0.35F, 0.6F) + 0.12F * octaves(p.u, 0.0F, 0.6F, 4, 0.6F, s.seed + 2, p.foot);
  const float tree = clamp01(0.5F + (horizon - p.v) / std::max(p.foot, 0.02F));
  const float sky = s.tone + 0.1F * octaves(p.u, p.v, 0.8F, 3, 0.5F, s.seed + 3, p.foot);
  const float leaves = 0.55F * s.tone + 0.2F * octaves(p.u, p.v, 0.15F, 5, 0.75F, s.seed + 4, p.foot);
  const float frame = std::max({covered_lines(p.u, 0.5F * p.width, 0.06F, p.foot), covered_lines(p.v, p.height, 0.09F, p.foot)});
  return mix(mix(sky, leaves, tree), 0.75F, frame);
}

float brick(const Skin& s, const Point& p) {
  constexpr float kLength = 0.24F, kHeight = 0.08F;
  const int row = floor_int(p.v / kHeight);
  const float shifted = p.u + (row % 2 == 0 ? 0.0F : 0.5F * kLength);
  const float mortar = std::max(covered_lines(shifted, kLength, 0.012F, p.foot), covered_lines(p.v, kHeight, 0.012F, p.foot));
  const float body = range(hash_cell(floor_int(shifted / kLength), row, s.seed), -0.12F, 0.12F) * resolved(kLength, p.foot);
  return mix(s.tone + body + 0.07F * octaves(p.u, p.v, 0.05F, 3, 0.7F, s.seed + 1, p.foot), s.tone + 0.22F, mortar);
}

float lamp(const Point& p) {
  const float frame = 1.0F - covered_rectangle(p.u, p.v, 0.03F, 0.03F, p.width - 0.03F, p.height - 0.03F, p.foot);
  return mix(1.5F - 0.15F * covered_lines(p.u, 0.1F, 0.012F, p.foot), 0.8F, frame);
}

}  // namespace

float texture_tone(const Skin& skin, const Point& p) {
  switch (skin.material) {
    case Material::kPaint: return paint(skin, p);
    case Material::kBlank: return skin.tone + 0.008F * octaves(p.u, p.v, 1.5F, 2, 0.5F, skin.seed, p.foot);
    case Material::kCarpet: return carpet(skin, p);
    case Material::kTiles: return tiles(skin, p);
    case Material::kLinoleum: return skin.tone + 0.02F * octaves(p.u, p.v, 0.5F, 5, 0.7F, skin.seed, p.foot);
    case Material::kCeiling: return ceiling(skin, p);
    case Material::kWood: return wood(skin, p);
    case Material::kRibs: return ribs(skin, p);
    case Material::kFabric: return fabric(skin, p);
    case Material::kCloth: return cloth(skin, p);
    case Material::kLamp: return lamp(p);
    case Material::kWindow: return window(skin, p);
    case Material::kBrick: return brick(skin, p);
    case Material::kPlain: return skin.tone + 0.02F * octaves(p.u, p.v, 0.1F, 2, 0.5F, skin.seed, p.foot);
    default: return print_tone(skin, p);
  }
}

bool is_emissive(Material material) {
  return material == Material::kLamp || material == Material::kWindow || material == Material::kScreen;
}

}  // namespace camloc::sim
