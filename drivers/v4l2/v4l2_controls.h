// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Exposure, gain, white balance and whatever else a camera calls a control, set by the names that v4l2-ctl lists.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "drivers/v4l2/v4l2_device.h"

namespace camloc {

struct V4l2Control {
  std::uint32_t id = 0;
  std::uint32_t type = 0;   ///< V4L2_CTRL_TYPE_*
  std::uint32_t flags = 0;  ///< V4L2_CTRL_FLAG_*
  std::string name;         ///< as control_name() makes it
  std::int64_t minimum = 0, maximum = 0;
  std::uint64_t step = 1;
};

/// "Exposure, Auto" -> "exposure_auto": letters and digits in lower case, whatever is between them as one underscore.
[[nodiscard]] std::string control_name(std::string_view name);

/// The controls that a number, a switch or a menu entry can be given to. Bounded.
[[nodiscard]] std::vector<V4l2Control> list_v4l2_controls(const V4l2Device& device);

/// Sets `wanted` (name -> number, "on"/"off" for switches, entry of a menu by number or by name). Switches and menus are set
/// first, since "manual exposure" must come before the exposure. kInvalid names the control, what the device takes and, for one
/// that it does not have, all that it has.
[[nodiscard]] Status set_v4l2_controls(const V4l2Device& device, const std::map<std::string, std::string>& wanted);

}  // namespace camloc
