// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Any packets in any order: the assembler writes only into its target, and what it calls a complete frame was filled by packets of
// that frame's numbers. The input is a row of packets, each with a length byte in front; bytes 0xff for the header's first two are
// read as "RB", so that the fuzzer need not find them. A small layout with as many packets a frame as the Kinect has.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "drivers/kinect/kinect_packets.h"
#include "drivers/kinect/kinect_protocol.h"

namespace {

constexpr std::size_t kPayloadBytes = 4, kGuardBytes = 64;
constexpr std::uint8_t kGuard = 0xa5;

void check(const camloc::kinect::StreamLayout& layout, const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> memory(layout.frame_bytes + 2 * kGuardBytes, kGuard);
  camloc::kinect::FrameAssembler assembler(layout);
  assembler.set_target({memory.data() + kGuardBytes, layout.frame_bytes});
  std::vector<std::uint8_t> packet;
  std::uint64_t num_complete = 0, num_since_frame = 0;
  for (std::size_t at = 0; at < size;) {
    const std::size_t length = std::min<std::size_t>(data[at] % 24, size - at - 1);
    packet.assign(data + at + 1, data + at + 1 + length);
    at += 1 + length;
    if (packet.size() >= 2 && packet[0] == 0xff && packet[1] == 0xff) packet[0] = 'R', packet[1] = 'B';
    ++num_since_frame;
    if (assembler.push(packet, static_cast<std::int64_t>(at)) != camloc::kinect::PacketResult::kFrameComplete) continue;
    ++num_complete;
    if (num_since_frame < layout.packets_per_frame()) std::abort();  // a frame out of too few packets
    num_since_frame = 0;
  }
  const auto is_guard = [](std::uint8_t byte) { return byte == kGuard; };
  if (!std::all_of(memory.begin(), memory.begin() + kGuardBytes, is_guard)) std::abort();
  if (!std::all_of(memory.end() - kGuardBytes, memory.end(), is_guard)) std::abort();
  if (assembler.counts().frames_complete != num_complete) std::abort();
  if (assembler.counts().lost > 256 * (assembler.counts().packets + 1)) std::abort();  // never below zero
  assembler.resynchronize();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace camloc::kinect;
  check({kDepthFlagBase, 242 * kPayloadBytes - 1, kPayloadBytes}, data, size);
  check({kColorFlagBase, 3 * kPayloadBytes - 3, kPayloadBytes}, data, size);
  return 0;
}
