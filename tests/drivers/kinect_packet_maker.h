// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The packets that a Kinect would send, and frames whose content says which they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "drivers/kinect/kinect_packets.h"
#include "drivers/kinect/kinect_protocol.h"

namespace camloc::kinect {

using Packet = std::vector<std::uint8_t>;

/// Differs from frame to frame in every packet, at every byte.
inline std::vector<std::uint8_t> numbered_frame(const StreamLayout& layout, std::uint32_t number) {
  std::vector<std::uint8_t> bytes(layout.frame_bytes);
  std::uint32_t state = number * 2654435761U + 12345U;
  for (std::uint8_t& byte : bytes) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<std::uint8_t>(state >> 24);
  }
  return bytes;
}

/// Cuts frames into packets as the device does: 60 MHz stamps, sequence numbers over all packets.
class PacketMaker {
 public:
  explicit PacketMaker(const StreamLayout& layout, std::uint8_t first_sequence = 0, std::uint32_t first_stamp = 1'000'000)
      : layout_(layout), sequence_(first_sequence), stamp_(first_stamp) {}

  std::vector<Packet> packets_of(const std::vector<std::uint8_t>& frame) {
    std::vector<Packet> packets;
    const std::size_t count = layout_.packets_per_frame();
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t kind = i == 0 ? kFlagStart : i + 1 == count ? kFlagEnd : kFlagMiddle;
      const std::size_t begin = i * layout_.payload_bytes, end = std::min(begin + layout_.payload_bytes, frame.size());
      packets.push_back(
          packet(kind, {frame.begin() + static_cast<std::ptrdiff_t>(begin), frame.begin() + static_cast<std::ptrdiff_t>(end)}));
    }
    stamp_ += kFrameTicks;
    return packets;
  }
  void skip_sequence(int count) { sequence_ = static_cast<std::uint8_t>(sequence_ + count); }
  void skip_frames(std::uint32_t count) { stamp_ += count * kFrameTicks; }
  [[nodiscard]] std::uint32_t stamp() const { return stamp_; }

  static constexpr std::uint32_t kFrameTicks = 2'000'000;

 private:
  Packet packet(std::uint8_t kind, const std::vector<std::uint8_t>& payload) {
    Packet packet{'R', 'B', 0, static_cast<std::uint8_t>(layout_.flag_base + kind), 0, sequence_++, 0, 0};
    for (int shift = 0; shift < 32; shift += 8) packet.push_back(static_cast<std::uint8_t>(stamp_ >> shift));
    packet.insert(packet.end(), payload.begin(), payload.end());
    return packet;
  }
  StreamLayout layout_;
  std::uint8_t sequence_;
  std::uint32_t stamp_;
};

}  // namespace camloc::kinect
