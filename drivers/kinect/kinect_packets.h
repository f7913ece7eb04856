// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames from isochronous packets (layout: kinect_protocol.h). USB repeats nothing: a lost packet leaves a hole, and a frame with
// a hole is thrown away. Neither knows USB nor time, so that every fault can be played to it.
//
// Where a packet belongs follows from its sequence number: a frame has fewer than 256 packets, so the distance from the frame's
// first packet is unique. A frame is complete only when every place was filled exactly by a packet of the right length, the first
// and the last flags stand at the first and the last place, and the stamps are those of one exposure. That catches also what
// looks continuous: 256 packets lost at once put the end of the frame in the wrong place, and a stall of exactly 128 frames,
// after which sequence and place agree again, gives itself away by the stamp.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {

struct PacketHeader {
  std::uint8_t flag = 0;
  std::uint8_t sequence = 0;
  std::uint32_t stamp = 0;
};
/// nullopt: shorter than a header, or not of a Kinect.
[[nodiscard]] std::optional<PacketHeader> parse_packet_header(std::span<const std::uint8_t> packet);

struct StreamLayout {
  std::uint8_t flag_base = 0;
  std::size_t frame_bytes = 0;
  std::size_t payload_bytes = 0;
  [[nodiscard]] std::size_t packets_per_frame() const { return (frame_bytes + payload_bytes - 1) / payload_bytes; }
};
[[nodiscard]] constexpr StreamLayout color_layout() { return {kColorFlagBase, kColorFrameBytes, kColorPayloadBytes}; }
[[nodiscard]] constexpr StreamLayout depth_layout() { return {kDepthFlagBase, kDepthFrameBytes, kDepthPayloadBytes}; }

struct PacketCounts {
  std::uint64_t packets = 0;  ///< that were of this stream
  std::uint64_t lost = 0;     ///< by the gaps in the sequence numbers
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;  ///< came after a successor, in time for their place or not
  std::uint64_t frames_complete = 0;
  std::uint64_t frames_incomplete = 0;  ///< begun, or known to have been begun, and thrown away
};

/// What a packet has brought about.
enum class PacketResult : std::uint8_t { kNothing, kFrameComplete };

/// Not thread-safe. Never allocates.
class FrameAssembler {
 public:
  explicit FrameAssembler(const StreamLayout& layout);

  /// Where the next frames go, frame_bytes long, owned by the caller; what is under way is lost. Call it after every
  /// kFrameComplete to keep a frame; otherwise the next one is written over it.
  void set_target(std::span<std::uint8_t> target);
  /// Forgets the frame under way and the sequence, keeps the counts: for streams that are started again.
  void resynchronize();
  /// One packet of the stream, header and all; `arrival_ns` is any clock and comes back in first_arrival_ns().
  [[nodiscard]] PacketResult push(std::span<const std::uint8_t> packet, std::int64_t arrival_ns);

  /// Of the frame that push() has just completed: its device stamp (of its last packet) and the arrival of its first packet.
  [[nodiscard]] std::uint32_t stamp() const { return stamp_; }
  [[nodiscard]] std::int64_t first_arrival_ns() const { return first_arrival_ns_; }
  [[nodiscard]] const PacketCounts& counts() const { return counts_; }
  [[nodiscard]] const StreamLayout& layout() const { return layout_; }

 private:
  enum class State : std::uint8_t { kUnsynchronized, kBetweenFrames, kInFrame, kBroken };
  static constexpr std::size_t kMaxPackets = 256;

  void begin_frame(std::int64_t arrival_ns);
  void break_frame();
  [[nodiscard]] bool is_of_this_exposure(std::uint32_t stamp) const;
  [[nodiscard]] bool fits(std::size_t index, std::uint8_t kind, std::size_t payload_bytes) const;
  [[nodiscard]] PacketResult push_late(std::size_t behind, std::uint8_t kind, const PacketHeader& header,
                                       std::span<const std::uint8_t> payload);
  [[nodiscard]] PacketResult place(std::size_t index, const PacketHeader& header, std::span<const std::uint8_t> payload);

  StreamLayout layout_;
  std::size_t num_places_;
  std::span<std::uint8_t> target_;
  State state_ = State::kUnsynchronized;
  std::bitset<kMaxPackets> has_;
  std::size_t num_filled_ = 0;
  std::size_t next_index_ = 0;      ///< place of the packet expected next
  std::uint8_t next_sequence_ = 0;  ///< its number
  bool has_sequence_ = false;
  std::uint32_t stamp_ = 0;  ///< newest of the frame that is not 0
  std::int64_t first_arrival_ns_ = 0;
  PacketCounts counts_;
};

}  // namespace camloc::kinect
