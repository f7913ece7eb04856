// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Between the thread that handles USB and the one that asks for frames: packets go in, raw frames come out. The newest frames
// win.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "drivers/kinect/kinect_packets.h"

namespace camloc::kinect {

enum class Stream : std::uint8_t { kColor = 0, kDepth = 1 };
inline constexpr std::size_t kNumStreams = 2;

/// A frame as the device sent it.
struct RawFrame {
  std::vector<std::uint8_t> bytes;
  std::uint32_t device_stamp = 0;
  std::int64_t arrival_ns = 0;   ///< of its first packet, CLOCK_MONOTONIC
  std::int64_t complete_ns = 0;  ///< of its last
};

struct ReceiverReport {
  std::array<PacketCounts, kNumStreams> counts;
  std::array<std::uint64_t, kNumStreams> transport_errors{};  ///< packets that the host controller reported as failed
  std::array<std::int64_t, kNumStreams> last_packet_ns{};     ///< 0: none yet
  std::uint64_t frames_overwritten = 0;                       ///< complete, but nobody took them in time
  bool is_gone = false;
};

/// on_*() are for the USB thread, the rest for the other; both may run at once. Allocates at construction only.
class KinectReceiver {
 public:
  KinectReceiver();

  /// Packets of one transfer in order of arrival: on_packet for each that carries data, then one on_transfer.
  void on_packet(Stream stream, std::span<const std::uint8_t> packet, std::int64_t arrival_ns);
  void on_transfer(Stream stream, std::size_t num_errors, std::int64_t now_ns);
  /// The device is gone; wait() returns at once from now on.
  void on_gone();

  /// The oldest frame that is waiting, or nullptr. It belongs to the caller until release().
  [[nodiscard]] RawFrame* take(Stream stream);
  void release(Stream stream, RawFrame* frame);
  /// Until a frame was completed or thrown away since the last take(), the device is gone, or the time is over.
  void wait_until(std::chrono::steady_clock::time_point deadline);
  [[nodiscard]] ReceiverReport report() const;
  /// Forgets everything under way, keeps the counts; only while no packet can come.
  void restart();

 private:
  static constexpr std::size_t kNumFrames = 4;  ///< one being written, one being read, two waiting
  struct Channel {
    explicit Channel(const StreamLayout& layout);
    void write_to(RawFrame* frame);
    FrameAssembler assembler;  // USB thread only
    std::array<RawFrame, kNumFrames> frames;
    RawFrame* writing = nullptr;           // USB thread only
    std::int64_t packet_ns = 0;            // USB thread only
    std::vector<RawFrame*> free, waiting;  // with room for all
  };
  void publish(Stream stream);
  [[nodiscard]] Channel& channel(Stream stream) { return *channels_[static_cast<std::size_t>(stream)]; }

  std::array<std::unique_ptr<Channel>, kNumStreams> channels_;
  mutable std::mutex mutex_;  // of free, waiting, report_ and num_events_; held for moving pointers and counts only
  std::condition_variable changed_;
  ReceiverReport report_;
  std::uint64_t num_events_ = 0, num_seen_ = 0;
};

// ---- which depth image belongs to which colour image: the two cameras run at one rate and on one clock, but not in step

enum class Pairing : std::uint8_t {
  kWait,        ///< more has to come
  kPair,        ///< the two belong together
  kColorAlone,  ///< the depth of this colour image is missing
  kDropDepth,   ///< the colour of this depth image is missing
};

/// For the oldest colour and the oldest depth image that are waiting, by their device stamps (32 bits, wrapping). Images of one
/// rate that are at most half a period apart are each other's nearest. `is_overdue`: depth for this colour would be here by now.
[[nodiscard]] constexpr Pairing decide_pairing(std::optional<std::uint32_t> color, std::optional<std::uint32_t> depth, bool is_overdue,
                                               std::int32_t half_period_ticks) {
  if (!color) return Pairing::kWait;
  if (!depth) return is_overdue ? Pairing::kColorAlone : Pairing::kWait;
  const auto depth_after_color = static_cast<std::int32_t>(*depth - *color);
  if (depth_after_color > half_period_ticks) return Pairing::kColorAlone;
  return depth_after_color < -half_period_ticks ? Pairing::kDropDepth : Pairing::kPair;
}

}  // namespace camloc::kinect
