// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Is this evidence of a pose? An inlier count alone does not tell: on real frames of another place 16 of 16 poses had
// 15 inliers or more. Every test below must pass; the first that fails is the reason the caller hears.
#pragma once

#include "core/localize/localization.h"
#include "core/localize/localizer_numbers.h"
#include "core/registration/rivals.h"

namespace camloc {

/// kNone means verified.
[[nodiscard]] Reason verify(const PoseEvidence& evidence, const Standing& standing, bool is_tracked, const LocalizerNumbers& numbers);

/// Does the focal length that the matches ask for contradict the assumed one?
[[nodiscard]] bool is_calibration_mismatch(const PoseEvidence& evidence, const LocalizerNumbers& numbers);

/// 0..100 for people and for thresholds of subscribers: how far above the limits of verification a pose is.
[[nodiscard]] int quality_of(const PoseEvidence& evidence, double margin);

}  // namespace camloc
