// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What was seen in each frame of a recording, in a file beside the map while it is built. The map is made in two passes: where was
// the camera, then what did it see from there; the log spares the second pass the images, and a build that was interrupted
// goes on from it with the very same state, because every frame so far is processed again in the same order.
//
// Layout, little-endian: a 64-byte header (magic, version, identity of the build), then records: RecordHeader, the arrays of
// the frame, an XXH3 hash over both. A record that was cut off by a crash is where the log ends.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "core/dense/thumbnail.h"
#include "core/registration/frame_features.h"

namespace camloc::mapping {

struct LoggedFrame {
  std::uint64_t frame = 0;                 ///< index in the recording
  FrameFeatures view;                      ///< the pose is not kept; the patches are where there are some
  Thumbnail thumbnail;                     ///< may be empty
  std::vector<Eigen::Vector3f> surface_m;  ///< coarse sample of what the depth camera saw, in the camera frame
};

/// Makes the log of a build that build's own: whoever else asks is refused for as long as the descriptor is open. A log that is there
/// stays as it is. Links are not followed: the folder of maps may be one that others write to.
/// kUnavailable: another build has it; kInvalid: the path is something else than a log, which is left alone; kIo.
[[nodiscard]] Result<UniqueFd> lock_frame_log(const std::string& path);

/// Appends frames. Not thread-safe.
class FrameLogWriter {
 public:
  /// A new log; an old one at the path is replaced. `identity` names recording, camera and options: a log is only good for
  /// the build that wrote it.
  static Result<FrameLogWriter> create(const std::string& path, std::uint64_t identity);
  /// Goes on after the first `size_bytes` of an existing log.
  static Result<FrameLogWriter> append(const std::string& path, std::uint64_t size_bytes);
  /// kIo when the disk is full; the frames before are safe.
  [[nodiscard]] Status add(const LoggedFrame& view);
  [[nodiscard]] Status flush();

 private:
  FrameLogWriter() = default;
  std::string path_;
  std::ofstream file_;
  std::vector<char> bytes_;
};

/// Reads frames in their order. Not thread-safe.
class FrameLogReader {
 public:
  /// kNotFound; kCorrupt for another kind of file; kInvalid where the log belongs to another build.
  static Result<FrameLogReader> open(const std::string& path, std::uint64_t identity);
  /// kEnd after the last whole record.
  [[nodiscard]] Status next(LoggedFrame* view);
  /// Where the records read so far end.
  [[nodiscard]] std::uint64_t size_bytes() const { return position_; }

 private:
  FrameLogReader() = default;
  std::string path_;
  std::ifstream file_;
  std::uint64_t position_ = 0, file_bytes_ = 0;
  std::vector<char> bytes_;
};

}  // namespace camloc::mapping
