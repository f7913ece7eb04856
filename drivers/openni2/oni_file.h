// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The .oni recordings of OpenNI and OpenNI2, read without OpenNI. Its own player (OniFile 2.2) runs beyond the ends of its
// buffers on broken files, hangs or crashes when it seeks, drops frames when it is fast and never says that a recording is
// over; a file needs none of that. The format as we understand it from recordings and OpenNI2's public sources; all numbers
// little endian, nothing aligned:
//
//   file    "NI10", version u8 u8 u16 u32, latest stamp u64, largest node id u32; then records
//   record  "NIR\0", type u32, node id u32, fields size u32 (from the magic on), payload size u32, position of an older record
//           u64 (u32 in files before version 1.0.1.0), fields, payload
//   text    length u32 with its final NUL, bytes
//
//   type 2, 12, 13  node added: name, node type u32 (1 device, 2 depth, 3 image, 5 infrared), codec of 4 letters; from type 12
//                   on number of frames u32, first and last stamp u64; in type 13 position of the seek table
//   type 3 to 6     property (integer u64, real f64, text, general): name, size u32, bytes
//   type 10         frame: stamp in microseconds u64, number u32; the payload is the image
//   type 11         the end; what follows is left over
//   types 7, 8, 9, 14  node removed, data begins, node ready, seek table: not needed here
//
// The recorder counts the stamps of every stream from that stream's own first frame, and writes the number of frames and the
// end only when it is closed in order: a recording that was cut off is read up to its last whole frame.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/base/unique_fd.h"
#include "drivers/openni2/pixel_layout.h"

namespace camloc::openni2 {

enum class OniNode : std::uint8_t { kDepth, kColor, kInfrared };

/// How the frames of a stream look from some record on.
struct OniFormat {
  int width = 0;
  int height = 0;
  PixelFormat pixels;
  bool is_mirrored = false;
  bool is_cropped = false;
  double horizontal_fov_rad = 0;  ///< 0 where the recording does not say
  double vertical_fov_rad = 0;
  bool operator==(const OniFormat& other) const = default;
};

struct OniFrameEntry {
  std::uint64_t position = 0;  ///< of the payload in the file
  std::uint32_t size = 0;      ///< of the payload
  std::uint32_t format = 0;    ///< index into OniStream::formats
  std::int64_t stamp_us = 0;
};

struct OniStream {
  OniNode node = OniNode::kDepth;
  OniCodec codec = OniCodec::kNone;
  std::vector<OniFormat> formats;
  std::vector<OniFrameEntry> frames;  ///< in the order of the file
};

/// An open recording and the index of its frames. Not thread-safe.
class OniFile {
 public:
  /// Reads every record's head, not the images. kNotFound, kIo; kInvalid: no .oni file or not a regular file; kUnsupported: a
  /// version, codec or pixel format that is not read; kCorrupt: broken before its first frame.
  [[nodiscard]] static Result<OniFile> open(const std::string& path);

  /// The first stream of its kind that has frames, or null.
  [[nodiscard]] const OniStream* find(OniNode node) const;
  /// Why reading ended before the end record; ok for a whole recording.
  [[nodiscard]] const Status& truncation() const { return truncation_; }

  /// A frame's payload; the vector's capacity is reused.
  [[nodiscard]] Status read_payload(const OniFrameEntry& frame, std::vector<std::uint8_t>* bytes) const;

 private:
  OniFile(UniqueFd file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}

  UniqueFd file_;
  std::string name_;
  std::vector<OniStream> streams_;
  Status truncation_;
};

}  // namespace camloc::openni2
