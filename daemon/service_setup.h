// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From the texts of the configuration to what the parts are constructed with, and the checks that need more than one
// setting or a look at the disk.
#pragma once

#include <optional>

#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "daemon/capture_thread.h"
#include "daemon/config.h"
#include "daemon/map_slot.h"
#include "daemon/sinks/sinks.h"
#include "drivers/sources.h"

namespace camloc {

[[nodiscard]] CaptureOptions capture_options(const Config& config);
[[nodiscard]] MapSlotOptions map_slot_options(const Config& config);
[[nodiscard]] SinkOptions sink_options(const Config& config);

/// Contradictions that can be seen without a device: a source or a sink that is in no table, hints from other machines.
[[nodiscard]] Status check_settings(const Config& config, SourceTable sources = frame_sources(), SinkTable sinks = pose_sinks());
/// The calibration file, where one is named.
[[nodiscard]] Result<std::optional<RgbdCamera>> read_configured_camera(const Config& config);
/// The calibration to use with a source: the configured one, else the source's own. Errors (kInvalid) name both sides:
/// there is none, or its image size is not the source's.
[[nodiscard]] Result<RgbdCamera> match_camera(const Config& config, const std::optional<RgbdCamera>& configured,
                                              const FrameSourceInfo& source);
/// Everything above; opens the source too when it is a recording, which disturbs nobody. What may be missing at start
/// (map, device, network) is not looked at.
[[nodiscard]] Status check_config(const Config& config, SourceTable sources = frame_sources(), SinkTable sinks = pose_sinks());

/// Whether this process may open as many files as the daemon needs; its soft limit is raised where the hard one allows. kIo: it may not.
[[nodiscard]] Status check_resource_limits();

/// Names of settings that differ and that a reload cannot change, comma-separated; empty when there are none.
[[nodiscard]] std::string changes_that_need_restart(const Config& from, const Config& to);

}  // namespace camloc
