// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Printed and man-made detail: posters, signs, sheets, book spines, keyboards, screens, boards, cardboard boxes.
#include "tools/camloc-sim/noise.h"
#include "tools/camloc-sim/texture.h"

namespace camloc::sim {
namespace {

float rotated_rectangle(const Point& s, float cu, float cv, float half_u, float half_v, float angle_rad) {
  const float c = std::cos(angle_rad), n = std::sin(angle_rad);
  const float x = c * (s.u - cu) + n * (s.v - cv), y = -n * (s.u - cu) + c * (s.v - cv);
  return covered_rectangle(x, y, -half_u, -half_v, half_u, half_v, s.foot);
}

/// Lines of text in the rectangle, ragged on the right.
float text_block(const Point& s, float u0, float v0, float u1, float v1, float line_height, std::uint32_t seed) {
  if (s.u < u0 || s.u > u1 || s.v < v0 || s.v > v1) return 0.0F;
  const int line = floor_int((v1 - s.v) / line_height);
  const float end = u0 + (u1 - u0) * range(hash_cell(line, 3, seed), 0.55F, 1.0F);
  if (s.u > end) return 0.0F;
  return text_ink(s.u - u0, v1 - s.v, line_height, seed, s.foot);
}

/// Overlapping discs and bars on a mottled ground.
float picture(const Point& s, std::uint32_t seed) {
  float tone = range(hash32(seed, 1), 0.25F, 0.8F) + 0.22F * octaves(s.u, s.v, 0.35F * s.width, 6, 0.65F, seed + 2, s.foot);
  const int num_shapes = 4 + static_cast<int>(hash32(seed, 3) % 5U);
  const float size = std::min(s.width, s.height);
  for (int k = 0; k < num_shapes; ++k) {
    const std::uint32_t h = hash32(seed, 100U + static_cast<std::uint32_t>(k));
    const float cu = range(hash32(h, 1), 0.1F, 0.9F) * s.width, cv = range(hash32(h, 2), 0.1F, 0.9F) * s.height;
    const float half = range(hash32(h, 3), 0.05F, 0.2F) * size;
    const float ink = h % 2U == 0U
                          ? covered_disc(s.u, s.v, cu, cv, half, s.foot)
                          : rotated_rectangle(s, cu, cv, half, half * range(hash32(h, 4), 0.25F, 1.0F), range(hash32(h, 5), 0.0F, 3.1F));
    tone = mix(tone, range(hash32(h, 6), 0.05F, 0.95F), ink);
  }
  return tone;
}

float bar_chart(const Point& s, std::uint32_t seed) {
  const float cell = s.width / 9.0F;
  const int i = floor_int(s.u / cell);
  const float height = s.height * range(hash_cell(i, 0, seed), 0.15F, 0.95F);
  const float bar = covered(s.u - static_cast<float>(i) * cell, 0.2F * cell, 0.9F * cell, s.foot) * covered(s.v, 0.0F, height, s.foot);
  return mix(0.92F, range(hash_cell(i, 1, seed), 0.1F, 0.6F), bar);
}

/// Blocks of all tones, as a floor plan or a city map.
float block_map(const Point& s, std::uint32_t seed) {
  const float cell = 0.07F;
  const float tone = filtered_lattice(s.u / cell, s.v / cell, s.foot / cell, 0.55F, [seed](int i, int j) {
    const std::uint32_t h = hash_cell(floor_int(static_cast<float>(i) / (1.0F + static_cast<float>(j & 1))), j, seed);
    return range(h, 0.15F, 0.95F);
  });
  const float streets = std::max(covered_lines(s.u, 3 * cell, 0.012F, s.foot), covered_lines(s.v, 2 * cell, 0.012F, s.foot));
  return mix(tone, 0.97F, streets);
}

float poster(const Point& s, std::uint32_t seed) {
  const float rim = 0.03F * s.width;
  const float inside = covered_rectangle(s.u, s.v, rim, rim, s.width - rim, s.height - rim, s.foot);
  const bool is_dark = hash32(seed, 9) % 3U == 0U;
  const float ground = is_dark ? 0.18F : 0.88F, ink = is_dark ? 0.9F : 0.1F;
  const float header = s.height * range(hash32(seed, 10), 0.72F, 0.86F), split = s.height * range(hash32(seed, 11), 0.25F, 0.45F);
  float tone = ground;
  if (s.v > header) {
    tone =
        mix(1.0F - ground, ground, text_block(s, 2 * rim, header, s.width - rim, s.height - rim, 0.45F * (s.height - header), seed + 20));
  } else if (s.v > split) {
    const Point area{s.u, s.v - split, s.width, header - split, s.foot};
    switch (hash32(seed, 12) % 4U) {
      case 0: tone = bar_chart(area, seed + 30); break;
      case 1: tone = block_map(area, seed + 30); break;
      default: tone = picture(area, seed + 30); break;
    }
  } else {
    const bool has_columns = hash32(seed, 13) % 2U == 0U;
    const float middle = has_columns ? 0.5F * s.width : s.width - rim;
    const float line = range(hash32(seed, 14), 0.015F, 0.03F);
    tone = mix(tone, ink, text_block(s, 2 * rim, rim, middle - rim, split - rim, line, seed + 40));
    if (has_columns) tone = mix(tone, picture({s.u - middle, s.v, s.width - middle, split, s.foot}, seed + 50), s.u > middle ? 1.0F : 0.0F);
  }
  return mix(is_dark ? 0.9F : 0.3F, tone, inside);
}

float sign(const Point& s, const Skin& skin) {
  const float rim = 0.06F * s.height;
  const float inside = covered_rectangle(s.u, s.v, rim, rim, s.width - rim, s.height - rim, s.foot);
  const float ink = text_block(s, 2 * rim, 0.0F, s.width - rim, s.height - rim, 0.48F * s.height, skin.seed);
  return mix(0.15F, mix(skin.tone, skin.tone > 0.5F ? 0.08F : 0.95F, ink), inside);
}

float paper(const Point& s, std::uint32_t seed) {
  const float rim = 0.09F * s.width;
  const float ink = text_block(s, rim, rim, s.width - rim, s.height - rim, 0.012F, seed);
  const float title = text_block(s, rim, s.height - 2.6F * rim, s.width - rim, s.height - rim, 0.03F, seed + 1);
  const float figure_v = s.height * range(hash32(seed, 2), 0.2F, 0.5F);
  const float figure =
      hash32(seed, 3) % 2U == 0U ? covered_rectangle(s.u, s.v, rim, figure_v, s.width - rim, figure_v + 0.2F * s.height, s.foot) : 0.0F;
  const float body = mix(0.92F, 0.15F, s.v > s.height - 2.6F * rim ? title : 0.8F * ink);
  return mix(body, figure > 0.0F ? picture({s.u, s.v - figure_v, s.width, 0.2F * s.height, s.foot}, seed + 4) : 0.5F, figure);
}

float books(const Point& s, std::uint32_t seed) {
  constexpr float kShelf = 0.34F, kBook = 0.042F;
  const int row = floor_int(s.v / kShelf);
  const float y = s.v - static_cast<float>(row) * kShelf;
  const float board = covered(y, 0.0F, 0.025F, s.foot);
  const auto edge = [&](int i) { return (static_cast<float>(i) + range(hash_cell(i, row, seed), -0.3F, 0.3F)) * kBook; };
  int i = floor_int(s.u / kBook);
  if (s.u < edge(i))
    --i;
  else if (s.u >= edge(i + 1))
    ++i;
  const std::uint32_t h = hash_cell(i, row, seed + 1);
  const float left = edge(i), right = edge(i + 1), top = 0.025F + range(hash32(h, 1), 0.19F, 0.29F);
  const bool is_gap = h % 17U == 0U;
  const float body = is_gap ? 0.0F : covered(s.u, left + 0.0015F, right - 0.0015F, s.foot) * covered(y, 0.025F, top, s.foot);
  float tone = range(hash32(h, 2), 0.08F, 0.9F);
  const float label_low = 0.05F + range(hash32(h, 3), 0.0F, 0.06F),
              label = covered(y, label_low, label_low + range(hash32(h, 4), 0.02F, 0.06F), s.foot);
  tone = mix(tone, tone > 0.5F ? 0.12F : 0.92F, 0.8F * label * static_cast<float>(hash32(h, 5) % 2U));
  // Titles run along the spine.
  const float title = y > 0.13F && y < top - 0.02F ? text_ink(y, s.u - left - 0.008F, 0.024F, h, s.foot) : 0.0F;
  tone = mix(tone, tone > 0.5F ? 0.1F : 0.9F, 0.85F * title);
  return mix(mix(0.10F, tone, body), 0.45F, board);
}

float keyboard(const Point& s, std::uint32_t seed) {
  constexpr float kKey = 0.0195F;
  const float gap = std::max(covered_lines(s.u, kKey, 0.004F, s.foot), covered_lines(s.v, kKey, 0.004F, s.foot));
  const float legend = filtered_lattice(s.u / (kKey / 4), s.v / (kKey / 4), s.foot / (kKey / 4), 0.1F, [seed](int i, int j) {
    return (i & 3) >= 1 && (j & 3) >= 1 && hash_cell(i, j, seed) % 3U == 0U ? 1.0F : 0.0F;
  });
  const float rim = 1.0F - covered_rectangle(s.u, s.v, 0.01F, 0.01F, s.width - 0.01F, s.height - 0.01F, s.foot);
  return mix(mix(mix(0.22F, 0.8F, 0.7F * legend), 0.05F, gap), 0.3F, rim);
}

float screen(const Point& s, std::uint32_t seed) {
  float tone = 0.3F + 0.1F * octaves(s.u, s.v, 0.2F, 3, 0.5F, seed, s.foot);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t h = hash32(seed, k + 5);
    const float u0 = range(hash32(h, 1), 0.0F, 0.5F) * s.width, v0 = range(hash32(h, 2), 0.05F, 0.45F) * s.height;
    const float u1 = u0 + 0.45F * s.width, v1 = v0 + 0.5F * s.height;
    const float pane = covered_rectangle(s.u, s.v, u0, v0, u1, v1, s.foot);
    if (pane <= 0.0F) continue;
    const float ground = h % 2U == 0U ? 0.85F : 0.15F;
    const float ink = text_block(s, u0 + 0.01F, v0 + 0.01F, u1, v1 - 0.03F, 0.014F, h);
    const float bar = covered(s.v, v1 - 0.018F, v1, s.foot);
    tone = mix(tone, mix(mix(ground, 1.0F - ground, ink), 0.5F, bar), pane);
  }
  const float inside = covered_rectangle(s.u, s.v, 0.015F, 0.02F, s.width - 0.015F, s.height - 0.015F, s.foot);
  return mix(0.05F, 0.85F * tone, inside);
}

float whiteboard(const Point& s, std::uint32_t seed) {
  const float inside = covered_rectangle(s.u, s.v, 0.03F, 0.03F, s.width - 0.03F, s.height - 0.03F, s.foot);
  const float pen = std::max(0.006F, 0.5F * s.foot);
  float ink = 0;
  const bool has_left_writing = s.u > 0.1F && s.u < 0.45F * s.width;
  if (has_left_writing) ink = 0.8F * text_block(s, 0.1F, 0.2F, 0.45F * s.width, s.height - 0.1F, 0.07F, seed);
  // Contour lines of smooth noise look like free-hand curves.
  const float hills = value_noise(s.u / 0.18F, s.v / 0.18F, seed + 1);
  if (s.u > 0.5F * s.width && s.u < 0.95F * s.width && s.v > 0.15F && s.v < s.height - 0.12F)
    ink = clamp01(1.5F - std::fabs(hills) * 0.08F / pen);
  return mix(0.45F, mix(0.93F, 0.2F, ink), inside);
}

float pinboard(const Point& s, std::uint32_t seed) {
  float tone = 0.5F + 0.12F * octaves(s.u, s.v, 0.02F, 3, 0.8F, seed, s.foot);
  constexpr float kCell = 0.24F;
  const int i = floor_int(s.u / kCell), j = floor_int(s.v / kCell);
  const std::uint32_t h = hash_cell(i, j, seed + 1);
  if (h % 5U != 0U) {
    const float w = range(hash32(h, 1), 0.10F, 0.2F), t = range(hash32(h, 2), 0.10F, 0.21F);
    const float u0 = (static_cast<float>(i) + 0.5F) * kCell - 0.5F * w, v0 = (static_cast<float>(j) + 0.5F) * kCell - 0.5F * t;
    const Point note{s.u - u0, s.v - v0, w, t, s.foot};
    const float inside = covered_rectangle(s.u, s.v, u0, v0, u0 + w, v0 + t, s.foot);
    if (inside > 0.0F) tone = mix(tone, h % 3U == 0U ? picture(note, h) : paper(note, h), inside);
    tone = mix(tone, 0.05F, covered_disc(s.u, s.v, u0 + 0.5F * w, v0 + t - 0.012F, 0.006F, s.foot));
  }
  const float frame = 1.0F - covered_rectangle(s.u, s.v, 0.03F, 0.03F, s.width - 0.03F, s.height - 0.03F, s.foot);
  return mix(tone, 0.25F, frame);
}

float cardboard(const Point& s, const Skin& skin) {
  float tone = skin.tone + 0.05F * octaves(s.u, s.v, 0.08F, 4, 0.6F, skin.seed, s.foot);
  tone = mix(tone, skin.tone + 0.18F, covered(s.u, 0.45F * s.width, 0.57F * s.width, s.foot));
  const float u0 = 0.1F * s.width, v0 = range(hash32(skin.seed, 1), 0.15F, 0.5F) * s.height, w = 0.3F * s.width, t = 0.25F * s.height;
  const float label = covered_rectangle(s.u, s.v, u0, v0, u0 + w, v0 + t, s.foot);
  const float ink = label > 0.0F ? text_ink(s.u - u0 - 0.01F, v0 + t - s.v, 0.03F, skin.seed + 2, s.foot) : 0.0F;
  tone = mix(tone, mix(0.93F, 0.1F, ink), label);
  const float mark = covered_disc(s.u, s.v, 0.78F * s.width, 0.3F * s.height, 0.1F * s.width, s.foot) -
                     covered_disc(s.u, s.v, 0.78F * s.width, 0.3F * s.height, 0.06F * s.width, s.foot);
  return mix(tone, 0.15F, clamp01(mark));
}

}  // namespace

float print_tone(const Skin& skin, const Point& s) {
  switch (skin.material) {
    case Material::kPoster: return poster(s, skin.seed);
    case Material::kSign: return sign(s, skin);
    case Material::kPaper: return paper(s, skin.seed);
    case Material::kBooks: return books(s, skin.seed);
    case Material::kKeyboard: return keyboard(s, skin.seed);
    case Material::kScreen: return screen(s, skin.seed);
    case Material::kWhiteboard: return whiteboard(s, skin.seed);
    case Material::kPinboard: return pinboard(s, skin.seed);
    case Material::kCardboard: return cardboard(s, skin);
    default: return skin.tone;
  }
}

}  // namespace camloc::sim
