// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Orientation by the intensity centroid and the rotated BRIEF descriptor (Rublee et al., 2011), with cv::ORB's arithmetic.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/features/descriptor.h"

namespace camloc {

/// Pixels a keypoint must keep from the border of its level: the rotated tests reach 18 pixels out.
inline constexpr int kOrbBorder = 19;

/// Angle of the centroid of the disc of radius 15 around `centre`, degrees in [0, 360], x towards y (downwards). Reads the
/// rows -15..15 from 15 pixels left to 16 pixels right of the centre.
[[nodiscard]] float orb_orientation_deg(const std::uint8_t* centre, std::ptrdiff_t stride);

/// Descriptor of the smoothed image around `centre`, turned by the angle.
[[nodiscard]] Descriptor orb_descriptor(const std::uint8_t* centre, std::ptrdiff_t stride, float angle_deg);

/// The same in radians, [0, 2 pi).
[[nodiscard]] float orb_angle_rad(float angle_deg);

}  // namespace camloc
