// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// oni://FILE: a recording of OpenNI or OpenNI2 as a depth camera.
#pragma once

#include <memory>

#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// Options: speed (0 = as fast as possible, 1 = as recorded), loop, frames, exclude as in replay://; registered=1 says that
/// the depth was registered to the colour image when it was recorded, which the file does not tell: then info().camera is
/// given where the file knows the field of view. A frame is a colour (else infrared) image with the depth image nearest in
/// time, at most 20 ms away, or without depth; its sequence is the index of the colour image in the file.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_oni_source(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
