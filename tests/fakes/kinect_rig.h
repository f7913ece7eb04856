// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole fake Kinect without transport: camera, motor, show, faults, the log of what was sent, and the text commands by which a
// running test changes it. A transport asks for packets and replies. Not thread-safe.
//
// Log, a line a frame: STREAM SHOW_INDEX STAMP_TICKS MONOTONIC_NS FORMAT DAMAGED HASH. DAMAGED is 1 when a fault touched one of its
// packets or the host did not take it; HASH is XXH3 (64 bits, hexadecimal) of the whole raw frame.
#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "core/base/result.h"
#include "tests/fakes/kinect_faults.h"
#include "tests/fakes/kinect_frames.h"
#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {

struct RigOptions {
  KinectOptions kinect;
  std::array<std::int16_t, 3> level_counts = {0, 819, 0};  ///< accelerometer of a level device
  BadDescriptors bad_descriptors = BadDescriptors::kNone;
  std::vector<std::string> faults;  ///< FaultInjector::configure
  std::uint64_t seed = 1;
  ReplayOptions replay;       ///< no folder: the pattern
  std::string log_file;       ///< empty: none
  std::string served_folder;  ///< each distinct raw frame goes here once, video-NNNNNN.raw and depth-NNNNNN.raw; empty: none
};

enum class UsbDeviceId { kCamera, kMotor };

class KinectRig {
 public:
  [[nodiscard]] static Result<std::unique_ptr<KinectRig>> create(const RigOptions& options);
  ~KinectRig();

  [[nodiscard]] UsbFunction& device(UsbDeviceId id);
  [[nodiscard]] const KinectMotor& motor() const { return *motor_; }
  [[nodiscard]] ControlReply control(UsbDeviceId id, const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns);
  /// What arrives at the host in the microframe at `now_ns`; `is_wanted` false: the host is not listening, what is sent is lost.
  void next_packet(StreamId stream, std::int64_t now_ns, bool is_wanted, IsoPacket* packet, bool* is_error);
  [[nodiscard]] bool is_streaming(StreamId stream) const { return camera_->is_streaming(stream); }
  /// CLOCK_MONOTONIC minus bus time, for the log.
  void set_monotonic_offset(std::int64_t offset_ns) { monotonic_offset_ns_ = offset_ns; }
  /// The cable was pulled, or the bus was reset.
  void power_cycle(std::int64_t now_ns);

  /// Members of a JSON object, without braces, that the transport adds to the counts.
  void set_extra_counts(std::function<std::string()> extra) { extra_counts_ = std::move(extra); }
  /// A command line of the control socket; the answer begins with "ok", "{" or "error: ".
  ///   fault KIND=PROBABILITY|KIND:TIMES    stall video|depth|both MILLISECONDS|forever    resume    counts
  [[nodiscard]] std::string command(std::string_view line, std::int64_t now_ns);

 private:
  struct SentFrame {
    FrameFormat format = FrameFormat::kBayer;
    std::uint64_t show_index = 0;
    std::uint32_t stamp_ticks = 0;
  };
  struct StreamState {
    SentFrame sent;  ///< the frame under way
    std::int64_t stalled_until_ns = 0;
    bool is_damaged = false;    ///< the same
    std::int64_t began_ns = 0;  ///< CLOCK_MONOTONIC
    std::uint64_t num_frames = 0, num_damaged = 0, num_packets = 0, num_unwanted = 0, num_stalled = 0;
    std::set<std::uint64_t> stored;  ///< show indices in the served folder
  };

  KinectRig() = default;
  void finish_frame(StreamId stream);
  void store_frame(StreamId stream, std::uint64_t index, std::span<const std::uint8_t> bytes);
  [[nodiscard]] Status stall(std::string_view which, std::string_view how_long, std::int64_t now_ns);
  [[nodiscard]] std::string counts(std::int64_t now_ns) const;

  std::unique_ptr<FrameShow> show_;
  std::unique_ptr<KinectCamera> camera_;
  std::unique_ptr<KinectMotor> motor_;
  std::unique_ptr<FaultInjector> faults_;
  std::array<StreamState, 2> streams_;
  std::FILE* log_ = nullptr;
  std::string served_folder_;
  std::function<std::string()> extra_counts_;
  std::int64_t monotonic_offset_ns_ = 0;
  std::uint64_t num_power_cycles_ = 0;
};

}  // namespace camloc::fakes
