// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Given poses are believed only where the recording's own frames show the same motion: some pairs of neighbours, spread over the recording,
// are registered from features and depth before a map is made.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/mapmaking/pose_convention.h"
#include "tools/mapping/build/posed_frames.h"

namespace camloc::mapping {

/// Reads the chosen frames of the recording. Errors are those of opening it.
[[nodiscard]] Result<PoseVerdict> check_poses(const PosedFramesRequest& request, const PosedFrames& frames, const RgbdCamera& camera,
                                              const OrbOptions& orb, WorkObserver& observer);

/// "the poses contradict the images: ...", with the numbers, what they fit as, and what to do.
[[nodiscard]] std::string describe_contradiction(const PoseVerdict& verdict, const std::string& poses);

}  // namespace camloc::mapping
