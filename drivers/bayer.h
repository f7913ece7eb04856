// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bayer mosaics, 8 bits a pixel, to grey and to colour by bilinear interpolation. Grey does not go by way of colour: every
// grey value is a weighted sum of the 3x3 pixels around it, which is what the frame path can afford.
#pragma once

#include <cstdint>

#include "core/base/frame.h"

namespace camloc {

/// Colours of the first two pixels of the first and of the second row.
enum class BayerOrder : std::uint8_t { kRggb, kGrbg, kGbrg, kBggr };

/// Luma of the bilinear interpolation: (19 R + 38 G + 7 B) / 64, rounded, ITU-R BT.601 weights in steps of 1/64, so that a plain
/// surface has one grey on all four kinds of pixel. Beyond the border the mosaic is mirrored (row -1 is row 1). `mosaic` is at
/// least 2x2 pixels; `gray` is resized to it.
void bayer_to_gray(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<std::uint8_t>* gray);

/// The bilinear interpolation itself: a colour that a pixel lacks is the rounded mean of its two or four nearest pixels of
/// that colour. Border and sizes as above.
void bayer_to_bgr(const ImageView<std::uint8_t>& mosaic, BayerOrder order, Image<Bgr>* color);

}  // namespace camloc
