// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From a frame source to a recording on disk. The calling thread takes frames from the source; threads of their own encode and
// write them, and in between is a bounded queue. Where it is full, a live camera's frame is dropped and counted, and a recorded
// source has to wait.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "drivers/frame_source.h"
#include "tools/recording/recording_folder.h"

namespace camloc::tools {

struct RecorderOptions {
  std::optional<std::uint64_t> max_frames;
  std::optional<double> max_seconds;            ///< by the stamps of the frames
  std::optional<RgbdCamera> camera;             ///< instead of the calibration that the source has
  int queue_frames = 60;                        ///< at least 1; a colour and a depth image of 640x480 take 1.5 MB
  int num_writers = 2;                          ///< threads, at least 1
  std::uint64_t min_free_bytes = 256ULL << 20;  ///< recording ends before less is left on the disk
  double max_silence_s = 10;                    ///< recording ends when no frame came for so long
};

struct RecordingSummary {
  std::uint64_t frames = 0, frames_with_depth = 0;  ///< that are named in the index
  std::uint64_t bytes = 0;                          ///< of the images
  std::uint64_t dropped = 0;                        ///< because the queue was full
  std::uint64_t missed = 0;                         ///< gaps in the numbering of a live source
  std::uint64_t corrupt = 0;                        ///< the source said so, or without an image
  std::uint64_t disordered = 0;                     ///< not later than the frame before
  std::uint64_t unwritten = 0;                      ///< were in the queue when writing failed
  std::uint64_t accelerations = 0;
  double seconds = 0;  ///< first to last stamp
  bool has_camera = false;
  FrameSourceHealth health;
  Status end;  ///< why it ended before its time; ok otherwise
};

struct RecorderProgress {
  std::uint64_t frames = 0, bytes = 0, dropped = 0;
  int queued = 0;
  std::uint64_t free_bytes = 0;
};

struct RecorderHooks {
  std::function<bool()> is_interrupted = [] { return false; };
  std::function<void(const RecorderProgress&)> on_progress = [](const RecorderProgress&) {};  ///< after every frame
  std::function<Result<std::uint64_t>(const std::string&)> free_bytes = free_bytes_at;        ///< of the folder
};

/// Records until the source ends, a limit is reached, or something fails; what was written until then is whole in each case.
/// kInvalid in `end`: the source has no colour although the format asks for it, or the camera does not fit the images.
[[nodiscard]] RecordingSummary record(FrameSource* source, RecordingFolder* folder, const RecordingFormat& format,
                                      const RecorderOptions& options, const RecorderHooks& hooks = {});

}  // namespace camloc::tools
