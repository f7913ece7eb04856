// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// v4l2://: any camera that the kernel has a driver for. One node gives the image (colour, grey or infrared) and another one
// depth, or there is one of them alone; two are paired by their stamps.
//
// Of health(), packets_lost counts the gaps in the driver's numbers, frames_incomplete what the driver marked as broken or what
// came short, and frames_unpaired what had no partner within half a frame.
#pragma once

#include <memory>

#include "drivers/frame_source.h"
#include "drivers/source_url.h"
#include "drivers/v4l2/v4l2_io.h"
#include "drivers/v4l2/v4l2_list.h"

namespace camloc {

/// v4l2://NODE?depth=NODE&...; NODE is a path, a link below /dev/v4l/by-id or serial:XXXX. Without NODE there is depth alone.
/// Nothing is allocated per frame, except by libjpeg for MJPEG.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_v4l2_source(const SourceUrl& url, const FrameSourceOptions& options);
/// The same on other system calls and trees than the kernel's.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_v4l2_source_on(std::shared_ptr<V4l2Io> io, const SystemFolders& folders,
                                                                       const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
