// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// kinect://: a Kinect V1 on USB as frame source, without any library of the device's own. Colour is 640x480 at 30 Hz, depth in
// millimetres. A frame is delivered only when every byte of it has arrived; where depth was lost and colour was not, the depth
// image is empty. Stamps are CLOCK_MONOTONIC of the start of the colour image's transmission, freed from the delays of USB.
#pragma once

#include <memory>

#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// Options: see parse_kinect_options().
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_kinect_source(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
