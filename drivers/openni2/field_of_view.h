// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Intrinsics from what OpenNI2 devices tell about their optics: the two fields of view, and nothing about distortion.
#pragma once

#include <optional>

#include "core/geometry/camera.h"

namespace camloc::openni2 {

/// An image and the angles it covers from edge to edge; 0 where the device does not say.
struct StreamGeometry {
  int width = 0;
  int height = 0;
  double horizontal_fov_rad = 0;
  double vertical_fov_rad = 0;
};

/// A pinhole in the middle of the image: f = size / (2 tan(fov / 2)), c = (size - 1) / 2 with pixel centres at integers. With
/// the horizontal angle alone the pixels are taken as square. Empty without it or with angles outside of 0.05 to 3.1 rad.
[[nodiscard]] std::optional<Intrinsics> intrinsics_of(const StreamGeometry& geometry);

/// Colour camera of `color` with depth that was registered to it, of the same view but possibly another size. Empty where the
/// field of view is not known. Without depth (size 0) depth takes the size of colour.
[[nodiscard]] std::optional<RgbdCamera> registered_camera(const StreamGeometry& color, int depth_width, int depth_height,
                                                          double depth_unit_m);

}  // namespace camloc::openni2
