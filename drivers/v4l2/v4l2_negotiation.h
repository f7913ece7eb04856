// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Agrees with a device on format, size and rate. What the device then says about rows and buffers is checked here, once, so
// that the frame path only has to look at how many bytes came.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "drivers/v4l2/v4l2_conversion.h"
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

/// What is required is taken or refused; of the rest what comes nearest is taken.
struct V4l2Wish {
  V4l2Role role = V4l2Role::kImage;
  std::optional<std::uint32_t> fourcc;  ///< required where given
  int width = 640, height = 480;
  bool is_width_required = false, is_height_required = false;
  double rate_hz = 30;
  bool is_rate_required = false;
  bool prefers_color = false;  ///< a format with colour before grey ones
};

struct V4l2Agreement {
  V4l2ImageLayout layout;
  double rate_hz = 0;  ///< 0: the device does not tell, and none was required
};

/// Bytes of a buffer beyond which a device is not believed.
inline constexpr std::size_t kMaxV4l2BufferBytes = std::size_t{256} << 20;

/// Sets format and rate. kUnsupported lists all that the device offers; kCorrupt: the device contradicts itself; kUnavailable:
/// gone or in use.
[[nodiscard]] Result<V4l2Agreement> negotiate_v4l2(const V4l2Device& device, const V4l2Wish& wish);

}  // namespace camloc
