// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A depth camera, live or recorded, behind one small interface. Which there are, and how to open one by its URL, is in sources.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/geometry/camera.h"

namespace camloc {

/// What `stamp_ns` of a source's frames counts.
enum class StampClock : std::uint8_t {
  kRecorded,   ///< what the recording says: seconds since the epoch by convention, its age means nothing
  kMonotonic,  ///< CLOCK_MONOTONIC of this machine, at the exposure
};

struct FrameSourceInfo {
  std::string description;                  ///< one line for people
  std::string serial;                       ///< of the device, empty where it has none
  int color_width = 0, color_height = 0;    ///< known after open for recordings, else of the first frame
  int depth_width = 0, depth_height = 0;    ///< 0 without depth
  std::optional<std::uint64_t> num_frames;  ///< of a recording, after selection
  std::optional<RgbdCamera> camera;         ///< where the source knows its own calibration
  StampClock stamp_clock = StampClock::kRecorded;
  std::vector<std::string> notes;  ///< what a recording lacks, for people: a line each
};

/// What a live source has seen go wrong since it was opened, and what else the device measures.
struct FrameSourceHealth {
  std::uint64_t packets_lost = 0;       ///< of the transport, where it counts them
  std::uint64_t frames_incomplete = 0;  ///< begun but thrown away, because a part of them was missing
  std::uint64_t frames_unpaired = 0;    ///< colour without depth of the same time, or depth without colour
  double clock_drift_ppm = 0;           ///< how much faster the device's clock runs than CLOCK_MONOTONIC
  /// Acceleration in the axes of the colour camera (x right, y down, z forward), m/s^2. At rest it is the reaction to gravity: it
  /// points up.
  std::optional<Eigen::Vector3d> acceleration;
};

struct FrameSourceOptions {
  bool wants_color = false;  ///< fill FrameBuffer::color, too, where the source has colour
};

/// Not thread-safe; belongs to the thread that calls next().
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const FrameSourceInfo& info() const = 0;
  /// Fills `frame` (buffers are reused) with the next exposure. kTimeout: nothing arrived, try again; kEnd: a recording is
  /// over; kUnavailable: the device is gone, open again; kCorrupt: this one frame is broken, the next may be fine.
  [[nodiscard]] virtual Status next(FrameBuffer* frame, std::chrono::milliseconds timeout) = 0;

  [[nodiscard]] virtual FrameSourceHealth health() const { return {}; }
  /// Stops the streams and starts them again, against a device that is there but delivers nothing. kUnsupported: the source
  /// knows no such thing; kUnavailable: it did not work, open again.
  [[nodiscard]] virtual Status restart() { return {ErrorCode::kUnsupported, "this source cannot be restarted"}; }
  /// Resets the device as if it were unplugged and plugged in. Afterwards the source is of no use: open again.
  [[nodiscard]] virtual Status reset_device() { return {ErrorCode::kUnsupported, "this source cannot reset its device"}; }
};

// ---- what a driver says about the cameras that are plugged in, for people and for choosing one

/// A camera that is plugged in.
struct FoundCamera {
  std::string url;      ///< that opens it
  std::string name;     ///< for people
  std::string where;    ///< on which bus or node
  std::string problem;  ///< why it cannot be asked, one line; empty where it can
};

/// What there is of one kind of camera now. Nothing is opened for streaming.
struct CameraListing {
  std::vector<FoundCamera> cameras;
  std::string searched;  ///< what was looked at: "5 USB devices"
  std::string problem;   ///< why cameras may be missing here, one line; empty where nothing is wrong
  std::string advice;    ///< what to do when one is missing, with the command where there is one
};

}  // namespace camloc
