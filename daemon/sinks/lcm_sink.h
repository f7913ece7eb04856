// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses out over LCM: camloc.pose_t for every frame, bot_core.pose_t while LOCALIZED, camloc.status_t. Messages are built and
// encoded in memory that is there from the start: nothing is allocated per frame but by LCM itself.
#pragma once

#include <memory>

#include "bot_core/pose_t.hpp"
#include "camloc/pose_t.hpp"
#include "camloc/status_t.hpp"
#include "daemon/sinks/pose_sink.h"

namespace camloc {

/// Numbers that do not fit their field are clipped.
void fill_pose(const PoseReport& report, pose_t* message);
/// Pose and capture time only; velocities are zero.
void fill_bot_core(const pose_t& pose, bot_core::pose_t* message);
void fill_status(const DaemonStatus& status, status_t* message);

[[nodiscard]] Result<std::unique_ptr<PoseSink>> open_lcm_sink(const SinkOptions& options);

}  // namespace camloc
