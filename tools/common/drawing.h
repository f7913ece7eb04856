// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Lines, dots and labels with smooth edges in a colour image: enough for a plan or a chart, without a drawing library. Pixel centres are
// at integers; what falls outside of the image is cut off, and what is not finite is not drawn.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "core/io/image_file.h"

namespace camloc::tools {

using Rgb = std::array<std::uint8_t, 3>;

[[nodiscard]] ColorImage blank_image(int width, int height, Rgb background);

/// With round ends: a line from a point to itself is a disc of this diameter.
void draw_line(ColorImage* image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb color, double width_px);
/// Filled.
inline void draw_disc(ColorImage* image, const Eigen::Vector2d& center, double radius_px, Rgb color) {
  draw_line(image, center, center, color, 2 * radius_px);
}
/// Filled; (u, v) is its upper left corner.
void draw_rectangle(ColorImage* image, int u, int v, int width, int height, Rgb color);
/// `height_px` is that of a capital letter; (u, v) is the left end of the line the text stands on. What is not printable ASCII is a '?'.
void draw_text(ColorImage* image, int u, int v, std::string_view text, double height_px, Rgb color);
[[nodiscard]] int text_width(std::string_view text, double height_px);

}  // namespace camloc::tools
