// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The learned sampling pattern of ORB.
#pragma once

#include <array>
#include <cstdint>

namespace camloc {

/// One bit of the descriptor: is the smoothed image darker at (x0, y0) than at (x1, y1)?
struct OrbTest {
  std::int8_t x0, y0, x1, y1;  ///< pixels from the keypoint, in its own orientation
};

extern const std::array<OrbTest, 256> kOrbPattern;

}  // namespace camloc
