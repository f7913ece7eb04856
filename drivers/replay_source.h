// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// replay://DIR: a recorded TUM RGB-D or 7-Scenes folder as a depth camera.
#pragma once

#include <memory>

#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// Options: speed (0 = as fast as possible, 1 = as recorded), loop, frames, exclude, rate_hz. A camera.toml in the folder
/// becomes info().camera. A frame's sequence is its index in the whole recording; every further round of a loop adds the
/// recording's number of frames to it and its length to the stamps.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_replay_source(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
