// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_packets.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/drivers/kinect_packet_maker.h"

namespace camloc::kinect {
namespace {

/// An assembler, the device before it, and all that came out.
struct Line {
  explicit Line(const StreamLayout& layout = depth_layout(), std::uint8_t first_sequence = 0)
      : layout_of(layout), maker(layout, first_sequence), assembler(layout), target(layout.frame_bytes) {
    assembler.set_target(target);
  }
  std::vector<Packet> next_packets() {
    truth[number] = numbered_frame(layout_of, number);
    stamps[number] = maker.stamp();
    return maker.packets_of(truth[number++]);
  }
  void push(const Packet& packet) {
    if (assembler.push(packet, ++time) != PacketResult::kFrameComplete) return;
    frames.push_back(target);
    frame_stamps.push_back(assembler.stamp());
    std::fill(target.begin(), target.end(), std::uint8_t{0});
  }
  void push(const std::vector<Packet>& packets) {
    for (const Packet& packet : packets) push(packet);
  }
  /// The number of a delivered frame, or -1 for one that was never sent.
  [[nodiscard]] int number_of(std::size_t delivered) const {
    for (const auto& [key, bytes] : truth) {
      if (bytes == frames[delivered]) return static_cast<int>(key);
    }
    return -1;
  }
  [[nodiscard]] const PacketCounts& counts() const { return assembler.counts(); }

  StreamLayout layout_of;
  PacketMaker maker;
  FrameAssembler assembler;
  std::vector<std::uint8_t> target;
  std::uint32_t number = 0;
  std::int64_t time = 0;
  std::map<std::uint32_t, std::vector<std::uint8_t>> truth;
  std::map<std::uint32_t, std::uint32_t> stamps;
  std::vector<std::vector<std::uint8_t>> frames;
  std::vector<std::uint32_t> frame_stamps;
};

TEST(KinectPackets, LayoutsAreTheDevices) {
  EXPECT_EQ(color_layout().packets_per_frame(), 162U);
  EXPECT_EQ(depth_layout().packets_per_frame(), 242U);
}

TEST(KinectPackets, UndisturbedStreamsComeOutBitForBit) {
  for (const StreamLayout& layout : {color_layout(), depth_layout()}) {
    Line line(layout, 200);
    for (int i = 0; i < 5; ++i) line.push(line.next_packets());
    ASSERT_EQ(line.frames.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(line.number_of(i), static_cast<int>(i));
      EXPECT_EQ(line.frame_stamps[i], line.stamps[static_cast<std::uint32_t>(i)]);
    }
    EXPECT_EQ(line.counts().frames_incomplete, 0U);
    EXPECT_EQ(line.counts().lost, 0U);
    EXPECT_EQ(line.counts().packets, 5 * layout.packets_per_frame());
  }
}

TEST(KinectPackets, StartInTheMiddleOfAFrameIsNoLoss) {
  Line line;
  std::vector<Packet> packets = line.next_packets();
  packets.erase(packets.begin(), packets.begin() + 100);
  line.push(packets);
  line.push(line.next_packets());
  ASSERT_EQ(line.frames.size(), 1U);
  EXPECT_EQ(line.number_of(0), 1);
  EXPECT_EQ(line.counts().frames_incomplete, 0U);
}

TEST(KinectPackets, EachLostPacketCostsItsFrameAndNoOther) {
  for (const std::size_t lost : {0U, 1U, 17U, 120U, 240U, 241U}) {
    Line line;
    line.push(line.next_packets());
    std::vector<Packet> packets = line.next_packets();
    packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(lost));
    line.push(packets);
    line.push(line.next_packets());
    ASSERT_EQ(line.frames.size(), 2U) << lost;
    EXPECT_EQ(line.number_of(0), 0) << lost;
    EXPECT_EQ(line.number_of(1), 2) << lost;
    EXPECT_EQ(line.counts().frames_incomplete, 1U) << lost;
    EXPECT_EQ(line.counts().lost, 1U) << lost;
  }
}

TEST(KinectPackets, DuplicatesAreIgnored) {
  Line line;
  for (int frame = 0; frame < 2; ++frame) {
    for (const Packet& packet : line.next_packets()) {
      line.push(packet);
      line.push(packet);
    }
  }
  ASSERT_EQ(line.frames.size(), 2U);
  EXPECT_EQ(line.number_of(1), 1);
  EXPECT_EQ(line.counts().lost, 0U);
  EXPECT_GE(line.counts().duplicates, 2 * 240U);
}

TEST(KinectPackets, NeighboursThatChangedPlacesArePutRight) {
  Line line;
  std::vector<Packet> packets = line.next_packets();
  std::swap(packets[50], packets[51]);
  std::swap(packets[100], packets[103]);
  line.push(packets);
  ASSERT_EQ(line.frames.size(), 1U);
  EXPECT_EQ(line.number_of(0), 0);
  EXPECT_EQ(line.counts().lost, 0U);
  EXPECT_GE(line.counts().late, 2U);
}

TEST(KinectPackets, ShortLongAndForeignPacketsBreakTheirFrame) {
  const auto damage = [](int kind, Packet* packet) {
    switch (kind) {
      case 0: packet->resize(packet->size() - 1); break;
      case 1: packet->push_back(0); break;
      case 2: packet->resize(5); break;
      case 3: (*packet)[0] = 'X'; break;
      case 4: (*packet)[3] = kColorFlagBase + kFlagMiddle; break;
      case 5: packet->resize(kPacketHeaderBytes); break;
      case 6: (*packet)[3] = kDepthFlagBase + kFlagEnd; break;
      case 7: packet->clear(); break;
      default: (*packet)[5] = static_cast<std::uint8_t>((*packet)[5] + 9); break;
    }
  };
  for (int kind = 0; kind < 9; ++kind) {
    Line line;
    std::vector<Packet> packets = line.next_packets();
    damage(kind, &packets[60]);
    line.push(packets);
    EXPECT_TRUE(line.frames.empty()) << kind;
    line.push(line.next_packets());
    line.push(line.next_packets());
    ASSERT_GE(line.frames.size(), 1U) << kind;
    EXPECT_EQ(line.number_of(line.frames.size() - 1), 2) << kind;
  }
}

TEST(KinectPackets, LossThatLooksContinuousIsSeen) {
  // 256 packets lost: the numbers go on as if nothing had been, in another frame.
  Line line;
  std::vector<Packet> packets = line.next_packets();
  for (int i = 0; i < 2; ++i) {
    const std::vector<Packet> more = line.next_packets();
    packets.insert(packets.end(), more.begin(), more.end());
  }
  packets.erase(packets.begin() + 100, packets.begin() + 356);
  line.push(packets);
  for (std::size_t i = 0; i < line.frames.size(); ++i) EXPECT_NE(line.number_of(i), -1);
  // A stall of 128 frames: number and place in the frame go on, the stamp does not.
  for (const StreamLayout& layout : {color_layout(), depth_layout()}) {
    Line stalled(layout);
    const std::vector<Packet> before = stalled.next_packets();
    stalled.maker.skip_frames(127);
    stalled.maker.skip_sequence(static_cast<int>(127 * layout.packets_per_frame()));
    const std::vector<Packet> after = stalled.next_packets();
    ASSERT_EQ(before[80][5], after[80][5]) << "the case to be tested";
    for (std::size_t i = 0; i < 80; ++i) stalled.push(before[i]);
    for (std::size_t i = 80; i < after.size(); ++i) stalled.push(after[i]);
    EXPECT_TRUE(stalled.frames.empty());
    EXPECT_EQ(stalled.counts().frames_incomplete, 1U);
  }
}

TEST(KinectPackets, SequenceMayStartAnewBetweenFrames) {
  Line line;
  line.push(line.next_packets());
  line.maker.skip_sequence(77);
  for (int i = 0; i < 3; ++i) line.push(line.next_packets());
  ASSERT_GE(line.frames.size(), 3U);
  EXPECT_EQ(line.number_of(line.frames.size() - 1), 3);
  line.assembler.resynchronize();
  line.maker.skip_sequence(-20);
  line.push(line.next_packets());
  EXPECT_EQ(line.number_of(line.frames.size() - 1), 4);
}

TEST(KinectPackets, StampsMayComeLateAndRunOn) {
  // Some firmware leaves the stamp of the first packets 0, and nobody promises that it stands still over a frame.
  Line line;
  std::vector<Packet> packets = line.next_packets();
  std::uint32_t stamp = 0xffff'0000U;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const std::uint32_t now = i < 3 ? 0 : stamp;
    for (std::size_t k = 0; k < 4; ++k) packets[i][8 + k] = static_cast<std::uint8_t>(now >> (8 * k));
    stamp += 7500;
  }
  line.push(packets);
  ASSERT_EQ(line.frames.size(), 1U);
  EXPECT_EQ(line.frame_stamps[0], stamp - 7500);
}

/// One fault at a random place of a run of packets.
void disturb(std::vector<Packet>* packets, std::mt19937* random) {
  const auto below = [random](std::size_t n) { return static_cast<std::size_t>((*random)() % n); };
  const auto at = [packets](std::size_t i) { return packets->begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t i = below(packets->size()), length = 1 + below(12);
  const std::size_t end = std::min(packets->size(), i + length);
  switch (below(9)) {
    case 0: packets->erase(at(i)); break;
    case 1: packets->erase(at(i), at(end)); break;
    case 2: packets->insert(at(i), Packet((*packets)[i])); break;
    case 3: std::shuffle(at(i), at(end), *random); break;
    case 4: (*packets)[i].resize(below((*packets)[i].size() + 1)); break;
    case 5:
      if (!(*packets)[i].empty())
        (*packets)[i][below(std::min<std::size_t>((*packets)[i].size(), 8))] = static_cast<std::uint8_t>((*random)());
      break;
    case 6: (*packets)[i].assign(below(40), static_cast<std::uint8_t>((*random)())); break;
    case 7: {  // a packet comes again much later
      const Packet copy = (*packets)[i];
      packets->insert(at(below(packets->size())), copy);
      break;
    }
    default:
      for (std::size_t k = i; k < packets->size(); ++k) {
        if ((*packets)[k].size() > 5) (*packets)[k][5] = static_cast<std::uint8_t>((*packets)[k][5] + length);
      }
  }
}

// The promise of the whole driver: whatever is lost, doubled, mixed or cut, a frame that comes out is one that was sent. As many
// packets a frame as the device has, but small ones.
TEST(KinectPackets, ThousandsOfRandomFaultsNeverMakeAWrongFrame) {
  constexpr StreamLayout kSmallColor{kColorFlagBase, 162 * 16 - 4, 16}, kSmallDepth{kDepthFlagBase, 242 * 16 - 4, 16};
  std::mt19937 random(20260101);
  int num_delivered = 0, num_sent = 0;
  for (int round = 0; round < 2000; ++round) {
    Line line(round % 2 == 0 ? kSmallColor : kSmallDepth, static_cast<std::uint8_t>(random()));
    std::vector<Packet> packets;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Packet> more = line.next_packets();
      packets.insert(packets.end(), more.begin(), more.end());
    }
    for (int fault = 0; fault < 8; ++fault) disturb(&packets, &random);
    line.push(packets);
    for (int i = 0; i < 2; ++i) line.push(line.next_packets());
    for (std::size_t i = 0; i < line.frames.size(); ++i) EXPECT_NE(line.number_of(i), -1) << "round " << round;
    ASSERT_FALSE(line.frames.empty());
    EXPECT_EQ(line.number_of(line.frames.size() - 1), 5) << "back in step after the faults, round " << round;
    num_delivered += static_cast<int>(line.frames.size());
    num_sent += 6;
  }
  EXPECT_GT(num_delivered, num_sent / 4);
}

TEST(KinectPackets, LossAtGivenRatesIsCounted) {
  std::mt19937 random(7);
  for (const double rate : {0.001, 0.01, 0.1}) {
    Line line(color_layout());
    std::uint64_t num_lost = 0;
    std::uint64_t num_whole = 0;
    line.push(line.next_packets());
    for (int frame = 0; frame < 60; ++frame) {
      bool is_whole = true;
      for (const Packet& packet : line.next_packets()) {
        if (std::bernoulli_distribution(rate)(random)) {
          ++num_lost;
          is_whole = false;
        } else {
          line.push(packet);
        }
      }
      num_whole += is_whole ? 1 : 0;
    }
    line.push(line.next_packets());
    EXPECT_EQ(line.frames.size(), num_whole + 2) << rate;
    EXPECT_EQ(line.counts().lost, num_lost) << rate;
    EXPECT_EQ(line.counts().frames_incomplete, 60 - num_whole) << rate;
  }
}

}  // namespace
}  // namespace camloc::kinect
