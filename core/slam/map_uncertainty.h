// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the keyframes of an adjusted map are from where they should be, once the map as a whole lies as well as it can: its deformation,
// and no pose that is found in it can be better. Neither the residuals nor the normal equations tell, since they know nothing of
// errors that neighbouring observations share. What tells is how far two maps disagree that are adjusted to half of the evidence
// each (McCarthy, "Pseudo-replication: half samples", 1969). What both halves have in common is not seen: errors of the calibration,
// which turn into errors of scale, and of images whose pixels are all off alike.
#pragma once

#include "core/slam/map_extract.h"

namespace camloc {

/// Standard deviations per axis, of a keyframe; 0 where there is too little to tell from.
struct MapUncertainty {
  double sigma_m = 0, sigma_rad = 0;
};

/// `extract` is a whole segment as it was adjusted with the same options. Control landmarks are in both halves: they say where the
/// map lies, not how it bends. The same extract gives the same bits.
[[nodiscard]] MapUncertainty estimate_uncertainty(const BundleOptions& bundle, const MapExtract& extract);

}  // namespace camloc
