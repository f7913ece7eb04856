// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_packets.h"

#include <cassert>
#include <cstring>

namespace camloc::kinect {

namespace {

/// A number this far behind the expected one is of a packet that came late; further behind it is a gap ahead.
constexpr int kReorderWindow = 64;
/// Two stamps of one frame differ by no more, in ticks: half a frame. The first packets may carry 0 for "not yet known".
constexpr std::uint32_t kMaxStampSpread = 1'000'000;

}  // namespace

std::optional<PacketHeader> parse_packet_header(std::span<const std::uint8_t> packet) {
  if (packet.size() < kPacketHeaderBytes || packet[0] != 'R' || packet[1] != 'B') return std::nullopt;
  return PacketHeader{packet[3], packet[5], double_word_at(packet, 8)};
}

FrameAssembler::FrameAssembler(const StreamLayout& layout) : layout_(layout), num_places_(layout.packets_per_frame()) {
  assert(num_places_ >= 2 && num_places_ < kMaxPackets);
}

void FrameAssembler::set_target(std::span<std::uint8_t> target) {
  assert(target.size() == layout_.frame_bytes);
  target_ = target;
  if (state_ == State::kInFrame) break_frame();
}

void FrameAssembler::resynchronize() {
  if (state_ == State::kInFrame) break_frame();
  state_ = State::kUnsynchronized;
  has_sequence_ = false;
}

void FrameAssembler::begin_frame(std::int64_t arrival_ns) {
  if (state_ == State::kInFrame) break_frame();
  state_ = State::kInFrame;
  has_.reset();
  num_filled_ = 0;
  stamp_ = 0;
  first_arrival_ns_ = arrival_ns;
}

void FrameAssembler::break_frame() {
  state_ = State::kBroken;
  ++counts_.frames_incomplete;
}

bool FrameAssembler::is_of_this_exposure(std::uint32_t stamp) const {
  if (stamp == 0 || stamp_ == 0) return true;
  const std::uint32_t ahead = stamp - stamp_;  // modulo 2^32, as the device counts
  return ahead <= kMaxStampSpread || 0U - ahead <= kMaxStampSpread;
}

bool FrameAssembler::fits(std::size_t index, std::uint8_t kind, std::size_t payload_bytes) const {
  if (index >= num_places_) return false;
  const bool is_first = index == 0, is_last = index + 1 == num_places_;
  if (kind != (is_first ? kFlagStart : is_last ? kFlagEnd : kFlagMiddle)) return false;
  return payload_bytes == (is_last ? layout_.frame_bytes - index * layout_.payload_bytes : layout_.payload_bytes);
}

PacketResult FrameAssembler::place(std::size_t index, const PacketHeader& header, std::span<const std::uint8_t> payload) {
  std::memcpy(target_.data() + index * layout_.payload_bytes, payload.data(), payload.size());
  has_[index] = true;
  if (header.stamp != 0) stamp_ = header.stamp;
  if (++num_filled_ < num_places_) return PacketResult::kNothing;
  state_ = State::kBetweenFrames;
  ++counts_.frames_complete;
  return PacketResult::kFrameComplete;
}

// A packet that came after `behind` successors, or once more.
PacketResult FrameAssembler::push_late(std::size_t behind, std::uint8_t kind, const PacketHeader& header,
                                       std::span<const std::uint8_t> payload) {
  const bool has_place = state_ == State::kInFrame && behind <= next_index_;
  const std::size_t index = has_place ? next_index_ - behind : 0;
  if (has_place && has_[index]) {
    ++counts_.duplicates;
    return PacketResult::kNothing;
  }
  ++counts_.late;
  if (!has_place || !fits(index, kind, payload.size()) || !is_of_this_exposure(header.stamp)) return PacketResult::kNothing;
  --counts_.lost;  // counted when its successor came
  return place(index, header, payload);
}

PacketResult FrameAssembler::push(std::span<const std::uint8_t> packet, std::int64_t arrival_ns) {
  assert(target_.size() == layout_.frame_bytes);
  const std::optional<PacketHeader> header = parse_packet_header(packet);
  const std::uint8_t kind = header ? static_cast<std::uint8_t>(header->flag - layout_.flag_base) : 0;
  if (!header || (kind != kFlagStart && kind != kFlagMiddle && kind != kFlagEnd)) {
    return PacketResult::kNothing;  // its number is not to be trusted; the gap that it leaves is counted with the next packet
  }
  ++counts_.packets;
  const std::span<const std::uint8_t> payload = packet.subspan(kPacketHeaderBytes);
  const int gap = has_sequence_ ? (header->sequence - next_sequence_) & 0xff : 0;
  if (gap >= 256 - kReorderWindow) return push_late(static_cast<std::size_t>(256 - gap), kind, *header, payload);

  counts_.lost += static_cast<std::uint64_t>(gap);
  if (kind == kFlagStart) begin_frame(arrival_ns);
  std::size_t index = kind == kFlagStart ? 0 : next_index_ + static_cast<std::size_t>(gap);
  if (index >= num_places_ && state_ != State::kUnsynchronized) {  // the first packet of a frame, at least, was in the gap
    if (state_ == State::kInFrame) break_frame();
    break_frame();
    index -= num_places_;
  }
  has_sequence_ = true;
  next_sequence_ = static_cast<std::uint8_t>(header->sequence + 1);
  next_index_ = index + 1;
  if (state_ == State::kInFrame) {
    if (fits(index, kind, payload.size()) && is_of_this_exposure(header->stamp)) return place(index, *header, payload);
    break_frame();
  }
  if (kind == kFlagEnd && state_ == State::kBroken) {
    state_ = State::kBetweenFrames;
    next_index_ = num_places_;
  }
  return PacketResult::kNothing;
}

}  // namespace camloc::kinect
