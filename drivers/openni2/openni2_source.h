// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// openni2://: any depth camera that an OpenNI2 driver is installed for.
#pragma once

#include <memory>

#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// openni2:// is the first device, openni2://URI, //INDEX or //SERIAL a certain one. Options: width, height, rate_hz ask for
/// modes with exactly these; without, modes near 640x480 at 30 Hz. Depth is registered to colour by the device where it can.
/// Without a colour sensor the infrared image is the grey one. Stamps are CLOCK_MONOTONIC at the exposure, but for the
/// smallest delay of the transport.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_openni2_source(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
