// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a v4l2:// URL to nodes that stream: finds them, agrees with them, sets their controls, starts them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "drivers/frame_source.h"
#include "drivers/source_url.h"
#include "drivers/v4l2/v4l2_io.h"
#include "drivers/v4l2/v4l2_list.h"
#include "drivers/v4l2/v4l2_stream.h"

namespace camloc {

struct V4l2Opened {
  std::shared_ptr<V4l2Io> io;
  std::unique_ptr<V4l2Stream> image, depth;  ///< one of them may be missing; after `io`, which they use until they are gone
  FrameSourceInfo info;                      ///< without description
  std::string usb_node;                      ///< of the image, or of depth alone; empty when not on USB
  std::optional<unsigned> gray_bits;         ///< significant bits of infrared pixels where the format does not say
  std::int64_t stamp_offset_ns = 0;
  bool gives_color = false;  ///< wanted, and the image has it
};

/// Errors name the node and the reason; see V4l2Device::open(), negotiate_v4l2(), set_v4l2_controls() for their codes. kInvalid names the
/// option and what it takes; errors of the camera file as read_camera_file().
[[nodiscard]] Result<V4l2Opened> open_v4l2_nodes(std::shared_ptr<V4l2Io> io, const SystemFolders& folders, const SourceUrl& url,
                                                 const FrameSourceOptions& options);

}  // namespace camloc
