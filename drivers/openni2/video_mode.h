// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of the video modes that a device offers a camera is set to. Pure.
#pragma once

#include <OniCTypes.h>

#include <optional>
#include <span>
#include <string>

#include "drivers/openni2/pixel_layout.h"

namespace camloc::openni2 {

/// What the user asks for. Zero: no matter, near 640x480 at 30 Hz.
struct ModeRequest {
  int width = 0;
  int height = 0;
  int fps = 0;
};

enum class StreamUse { kDepth, kImage };

/// The mode for the request, or nothing where no mode that is read has the size and rate asked for. Depth in millimetres is
/// preferred to tenths of them, whose 16 bits end at 6.5 m; RGB to YUV to grey, as RGB is what every device has been tried with.
[[nodiscard]] std::optional<OniVideoMode> choose_mode(std::span<const OniVideoMode> offered, StreamUse use, const ModeRequest& request);

/// "640x480@30 RGB888"; the number of a format that is not read.
[[nodiscard]] std::string describe(const OniVideoMode& mode);
[[nodiscard]] std::string describe(std::span<const OniVideoMode> modes);

}  // namespace camloc::openni2
