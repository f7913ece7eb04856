// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a patch shows what another patch shows in its middle, to a fraction of a pixel: inverse-compositional alignment (Baker and
// Matthews, "Lucas-Kanade 20 years on: a unifying framework", 2004) of a translation, after an affine warp that is known, with
// brightness and contrast free. A corner detector finds whole pixels of its level; this finds the point itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/features/descriptor.h"

namespace camloc {

enum class PatchVerdict : std::uint8_t {
  kAligned,
  kOutside,  ///< the warp leads out of the reference
  kFlat,     ///< too little texture, or an edge: nothing says where along it
  kLost,     ///< moved too far, or did not settle
  kUnlike,   ///< the patches do not show the same
};

struct PatchAlignment {
  PatchVerdict verdict = PatchVerdict::kLost;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of what the reference shows in its middle, from the middle of the target
  double correlation = 0;
  double sigma_px = 0;  ///< in the direction in which the position is known least
};

/// A pixel d of the target, counted from the point sought, corresponds to A_reference_target * d of the reference, counted from
/// its middle. Within a circle of five pixels around the point; the same patches give the same bits.
[[nodiscard]] PatchAlignment align_patch(const FeaturePatch& reference, const Eigen::Matrix2d& A_reference_target,
                                         const FeaturePatch& target);

}  // namespace camloc
