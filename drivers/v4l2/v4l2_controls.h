// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Exposure, gain, white balance and whatever else a camera calls a control, set by the names that v4l2-ctl lists.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "drivers/v4l2/v4l2_device.h"

namespace camloc {

/// "Exposure, Auto" -> "exposure_auto": letters and digits in lower case, whatever is between them as one underscore.
[[nodiscard]] std::string control_name(std::string_view name);

/// Sets `wanted` (name -> number, "on"/"off" for switches, entry of a menu by number or by name). Switches and menus are set
/// first, since "manual exposure" must come before the exposure. kInvalid names the control, what the device takes and, for one
/// that it does not have, all that it has.
[[nodiscard]] Status set_v4l2_controls(const V4l2Device& device, const std::map<std::string, std::string>& wanted);

}  // namespace camloc
