// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A depth camera, live or recorded, behind one small interface, chosen by URL.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

struct FrameSourceInfo {
  std::string description;                    ///< one line for people
  int color_width = 0, color_height = 0;      ///< known after open for recordings, else of the first frame
  int depth_width = 0, depth_height = 0;      ///< 0 without depth
  std::optional<std::uint64_t> num_frames;    ///< of a recording, after selection
  std::optional<RgbdCamera> camera;           ///< where the source knows its own calibration
};

/// Not thread-safe; belongs to the thread that calls next().
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const FrameSourceInfo& info() const = 0;
  /// Fills `frame` (buffers are reused) with the next exposure. kTimeout: nothing arrived, try again; kEnd: a recording is
  /// over; kUnavailable: the device is gone, open again; kCorrupt: this one frame is broken, the next may be fine.
  [[nodiscard]] virtual Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) = 0;
};

/// `scheme://rest?key=value&...`; a bare path means replay://path.
///   replay://DIR   TUM RGB-D or 7-Scenes folder; speed=1 (0 = as fast as possible, the default), loop=0|1,
///                  frames=start:stop:step[,...] (Python slice rules), rate_hz= for folders without stamps (30)
///   sample://      generated images; rate_hz=, frames=, width=, height=
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& url);

/// Schemes this build knows, with a line of help each.
struct FrameSourceScheme {
  std::string scheme;
  std::string help;
};
[[nodiscard]] std::vector<FrameSourceScheme> frame_source_schemes();

}  // namespace camloc
