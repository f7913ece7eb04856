// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a kinect:// URL asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "drivers/kinect/kinect_control.h"
#include "drivers/kinect/kinect_protocol.h"
#include "drivers/source_url.h"

namespace camloc::kinect {

enum class DepthMode : std::uint8_t {
  kRegistered,  ///< in the pixels of the colour camera; where the device gives no parameters for that, as kRaw
  kRaw,         ///< in the pixels of the infrared camera
  kOff,
};

struct KinectOptions {
  std::string selector;  ///< serial number, index, or empty for the first
  DepthMode depth = DepthMode::kRegistered;
  ColorControls color;
  bool is_led_status = true;  ///< the LED says how it goes: green, or blinking red and yellow
  std::optional<Led> fixed_led;
  std::optional<double> tilt_deg;  ///< against the horizon, up is positive
};

/// kinect://[SERIAL|INDEX]?depth=registered|raw|off, auto_exposure=0|1, exposure_us=, gain=, white_balance=auto|manual,
/// led=status|off|green|red|yellow|blink|keep, tilt_deg=. kInvalid: unknown or contradicting options.
[[nodiscard]] Result<KinectOptions> parse_kinect_options(const SourceUrl& url);

}  // namespace camloc::kinect
