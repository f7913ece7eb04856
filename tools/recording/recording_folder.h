// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording on disk in TUM RGB-D layout, as replay:// reads it: rgb/, depth/, rgb.txt, depth.txt, accelerometer.txt and
// camera.toml. A frame is named in an index only after its images are whole, so the folder is valid at every moment.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "core/geometry/camera.h"
#include "core/io/image_writer.h"

namespace camloc::tools {

struct RecordingFormat {
  bool is_color = false;  ///< write FrameBuffer::color instead of the grey image
  bool is_jpeg = false;   ///< else PNG, which keeps every bit; depth is always PNG
  int jpeg_quality = 95;  ///< 1 to 100
  PngCompression compression = PngCompression::kFast;
};

class RecordingFolder {
 public:
  /// Makes the folder. kInvalid where it exists and is not empty; with `replaces_old` the recording in it is deleted, unless
  /// something else is there, too.
  [[nodiscard]] static Result<RecordingFolder> create(const std::string& path, const RecordingFormat& format, bool replaces_old);

  [[nodiscard]] const std::string& path() const { return path_; }

  /// Writes the images of a frame and returns their bytes; any number of threads at a time. `stamp_ns`: since the epoch.
  [[nodiscard]] Result<std::uint64_t> write_images(const FrameBuffer& frame, std::int64_t stamp_ns) const;

  // One thread at a time; stamps ascend.
  [[nodiscard]] Status append_frame(std::int64_t stamp_ns, bool has_depth);
  /// `acceleration`: m/s^2 in the axes of the colour camera; the file holds it in those of the Kinect's sensor, which is what
  /// readers of such files expect.
  [[nodiscard]] Status append_acceleration(std::int64_t stamp_ns, const Eigen::Vector3d& acceleration);
  [[nodiscard]] Status write_camera(const RgbdCamera& camera) const;
  /// Waits until the indices are on the disk; its errors are those of the disk. The images follow when the kernel writes them, within
  /// half a minute: waiting for them, syncfs() waited for everybody else's files, too, up to a minute beside a compiler.
  [[nodiscard]] Status sync() const;
  /// Deletes the folder of a recording without a frame.
  void discard();

 private:
  RecordingFolder(std::string path, const RecordingFormat& format) : path_(std::move(path)), format_(format) {}
  [[nodiscard]] std::string color_name(std::int64_t stamp_ns) const;
  [[nodiscard]] Status open_index(const char* name, const std::string& title, UniqueFd* index) const;
  [[nodiscard]] Status append_line(const char* name, const UniqueFd& index, const std::string& line) const;

  std::string path_;
  RecordingFormat format_;
  UniqueFd color_index_, depth_index_, accelerometer_;
};

/// Seconds with nine decimals, as TUM files have them.
[[nodiscard]] std::string stamp_text(std::int64_t stamp_ns);

/// Bytes free for an ordinary user on the file system of `path`, or of its nearest folder that exists.
[[nodiscard]] Result<std::uint64_t> free_bytes_at(const std::string& path);

}  // namespace camloc::tools
