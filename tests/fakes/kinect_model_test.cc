// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_model.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/fakes/kinect_frames.h"

namespace camloc::fakes {
namespace {

constexpr std::int64_t kMicroframeNs = 125'000;
constexpr std::int64_t kSecond = 1'000'000'000;

UsbSetup vendor_out(std::size_t length) { return {0x40, 0, 0, 0, static_cast<std::uint16_t>(length)}; }
constexpr UsbSetup kVendorIn{0xc0, 0, 0, 0, 512};

/// "GM" command with words as arguments.
std::vector<std::uint8_t> command(std::uint16_t code, std::uint16_t tag, const std::vector<std::uint16_t>& words) {
  std::vector<std::uint8_t> bytes = {'G', 'M'};
  std::vector<std::uint16_t> all = {static_cast<std::uint16_t>(words.size()), code, tag};
  all.insert(all.end(), words.begin(), words.end());
  for (const std::uint16_t word : all) {
    bytes.push_back(static_cast<std::uint8_t>(word));
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  return bytes;
}

class KinectModelTest : public ::testing::Test {
 protected:
  /// Body of the reply, or empty.
  std::vector<std::uint8_t> ask(std::uint16_t code, const std::vector<std::uint16_t>& words, std::int64_t now_ns = 0) {
    const std::vector<std::uint8_t> bytes = command(code, 77, words);
    EXPECT_FALSE(camera_.control(vendor_out(bytes.size()), bytes, now_ns).is_stalled);
    const ControlReply reply = camera_.control(kVendorIn, {}, now_ns + kSecond);
    if (reply.data.size() < 8) return {};
    EXPECT_EQ(reply.data[0], 'R');
    EXPECT_EQ(reply.data[1], 'B');
    EXPECT_EQ(reply.data[2] | reply.data[3] << 8, static_cast<int>(reply.data.size() - 8) / 2);
    EXPECT_EQ(reply.data[4] | reply.data[5] << 8, code);
    EXPECT_EQ(reply.data[6] | reply.data[7] << 8, 77);
    return {reply.data.begin() + 8, reply.data.end()};
  }

  PatternShow show_;
  KinectOptions options_;
  KinectCamera camera_{options_, camera_descriptors(KinectModel::k1414, "serial"), &show_};
};

TEST_F(KinectModelTest, RemembersRegisters) {
  EXPECT_EQ(ask(0x03, {0x0e, 15}), std::vector<std::uint8_t>({0, 0}));
  EXPECT_EQ(ask(0x02, {0x0e}), std::vector<std::uint8_t>({0x0e, 0, 15, 0}));
  EXPECT_EQ(camera_.register_value(0x0e), 15);
}

TEST_F(KinectModelTest, ReplyTakesItsTimeAndIsReadOnce) {
  const auto bytes = command(0x02, 1, {0x0e});
  static_cast<void>(camera_.control(vendor_out(bytes.size()), bytes, 0));
  EXPECT_TRUE(camera_.control(kVendorIn, {}, options_.reply_delay_ns - 1).data.empty());
  EXPECT_EQ(camera_.control(kVendorIn, {}, options_.reply_delay_ns).data.size(), 12U);
  EXPECT_TRUE(camera_.control(kVendorIn, {}, kSecond).data.empty());
}

TEST_F(KinectModelTest, NeverAnswersNonsense) {
  auto bad_magic = command(0x02, 1, {0x0e});
  bad_magic[0] = 'X';
  auto bad_length = command(0x02, 1, {0x0e});
  bad_length[2] = 9;
  for (const auto& bytes : {bad_magic, bad_length, command(0x7777, 1, {0}), std::vector<std::uint8_t>{'G', 'M'}}) {
    static_cast<void>(camera_.control(vendor_out(bytes.size()), bytes, 0));
    EXPECT_TRUE(camera_.control(kVendorIn, {}, kSecond).data.empty());
  }
  EXPECT_EQ(camera_.num_bad_commands(), 4U);
}

TEST_F(KinectModelTest, TellsItsCalibration) {
  EXPECT_EQ(ask(0x04, {0, 0, 0, 0, 0}).size(), 322U);
  EXPECT_EQ(ask(0x16, {0x40, 0, 1, 30, 0}).size(), 118U);
  EXPECT_EQ(ask(0x16, {0x41, 0, 1, 30, 0}).size(), 8U);
  EXPECT_EQ(ask(0x16, {0x00, 0, 1, 30, 0}), std::vector<std::uint8_t>({0, 0, 200, 0}));
}

TEST_F(KinectModelTest, SensorRegistersAreWritable) {
  ask(0x95, {1, 0x8009, 500});
  EXPECT_EQ(ask(0x95, {1, 0x0009, 0}), std::vector<std::uint8_t>({1, 0, 9, 0, 0xf4, 1}));
}

TEST_F(KinectModelTest, DescriptorsAreCutToWhatIsAskedFor) {
  EXPECT_EQ(camera_.control({0x80, 6, 0x0100, 0, 64}, {}, 0).data.size(), 18U);
  EXPECT_EQ(camera_.control({0x80, 6, 0x0200, 0, 9}, {}, 0).data.size(), 9U);
  EXPECT_EQ(camera_.control({0x80, 6, 0x0303, 0x0409, 255}, {}, 0).data,
            std::vector<std::uint8_t>({14, 3, 's', 0, 'e', 0, 'r', 0, 'i', 0, 'a', 0, 'l', 0}));
  EXPECT_TRUE(camera_.control({0x80, 6, 0x0304, 0x0409, 255}, {}, 0).is_stalled);
}

/// A frame as the packets of a stream gave it.
struct Assembled {
  std::vector<std::uint8_t> bytes;
  std::uint32_t stamp = 0;
  std::uint64_t show_index = 0;
};

/// Runs the stream and puts its frames together by the rules of the header alone; fails the test where they are broken.
std::vector<Assembled> assemble(KinectCamera* camera, StreamId stream, std::int64_t from_ns, std::int64_t until_ns) {
  const int base = stream == StreamId::kVideo ? 0x80 : 0x70;
  std::vector<Assembled> frames;
  Assembled current;
  IsoPacket packet;
  int next_sequence = -1;
  for (std::int64_t t = from_ns; t < until_ns; t += kMicroframeNs) {
    camera->next_packet(stream, t, &packet);
    if (packet.size == 0) continue;
    const auto& b = packet.bytes;
    EXPECT_EQ(b[0], 'R');
    EXPECT_EQ(b[1], 'B');
    EXPECT_EQ(static_cast<std::size_t>(b[6] << 8 | b[7]), packet.size);
    EXPECT_TRUE(next_sequence < 0 || b[5] == next_sequence);
    next_sequence = (b[5] + 1) & 0xff;
    const std::uint32_t stamp = static_cast<std::uint32_t>(b[8] | b[9] << 8 | b[10] << 16) | static_cast<std::uint32_t>(b[11]) << 24;
    if (b[3] == base + 1) {
      current = {{}, packet.stamp_ticks, packet.show_index};
    } else {
      EXPECT_EQ(stamp, current.stamp);
    }
    current.bytes.insert(current.bytes.end(), b.begin() + kPacketHeaderBytes, b.begin() + static_cast<std::ptrdiff_t>(packet.size));
    if (b[3] == base + 5) frames.push_back(current);
  }
  return frames;
}

TEST_F(KinectModelTest, BothStreamsSendWholeFramesAtThirtyHertz) {
  ask(0x03, {0x05, 1}, 0);
  ask(0x03, {0x06, 2}, 0);
  for (const StreamId stream : kBothStreams) {
    const auto frames = assemble(&camera_, stream, 0, kSecond);
    ASSERT_GE(frames.size(), 29U);
    ASSERT_LE(frames.size(), 31U);
    const FrameFormat format = stream == StreamId::kVideo ? FrameFormat::kBayer : FrameFormat::kDepth11;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto expected = show_.frame(format, frames[i].show_index);
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), frames[i].bytes.begin(), frames[i].bytes.end()));
      if (i == 0) continue;
      EXPECT_NEAR(frames[i].stamp - frames[i - 1].stamp, 2e6, 2) << "ticks of 1/30 s";
      EXPECT_TRUE(i == 1 || frames[i].show_index == frames[i - 1].show_index + 1);
    }
  }
}

TEST_F(KinectModelTest, ColorOfAnExposureShowsWhatDepthShows) {
  ask(0x03, {0x06, 2}, 0);
  ask(0x03, {0x05, 1}, 50'000'000);
  const auto depth = assemble(&camera_, StreamId::kDepth, 50'000'000, kSecond);
  const auto color = assemble(&camera_, StreamId::kVideo, 50'000'000, kSecond);
  int num_pairs = 0;
  for (const Assembled& c : color) {
    for (const Assembled& d : depth) {
      if (c.stamp - d.stamp > 600'000U) continue;  // colour follows within 10 ms
      EXPECT_EQ(c.show_index, d.show_index);
      ++num_pairs;
    }
  }
  EXPECT_GE(num_pairs, 25);
}

TEST(KinectClock, WrapsAndDrifts) {
  PatternShow show;
  KinectOptions options;
  options.clock_start = 0xffffff00U;
  options.clock_ppm = 100;
  const KinectCamera camera(options, camera_descriptors(KinectModel::k1414, "s"), &show);
  EXPECT_EQ(camera.ticks_at(0), 0xffffff00U);
  EXPECT_EQ(camera.ticks_at(10 * kSecond), static_cast<std::uint32_t>(0xffffff00U + 600'060'000U));
}

TEST(KinectMotorTest, TurnsAtItsRateAndGravityTurnsWithIt) {
  KinectMotor motor(motor_descriptors(KinectModel::k1414), {0, 819, 0});
  const auto state = [&](std::int64_t now_ns) { return motor.control({0xc0, 0x32, 0, 0, 10}, {}, now_ns).data; };
  EXPECT_EQ(motor.control({0xc0, 0x10, 0, 0, 1}, {}, 0).data, std::vector<std::uint8_t>{0x22});
  EXPECT_FALSE(motor.control({0x40, 0x31, 2 * 27, 0, 0}, {}, 0).is_stalled);
  EXPECT_EQ(state(kSecond / 2)[9], 4) << "moving";
  const auto still = state(2 * kSecond);
  EXPECT_EQ(still[9], 0);
  EXPECT_EQ(static_cast<std::int8_t>(still[8]), 54);
  const auto axis = [&](std::size_t at) { return static_cast<std::int16_t>(still[at] << 8 | still[at + 1]); };
  EXPECT_EQ(axis(2), 0);
  EXPECT_NEAR(axis(4), 819 * 0.8910, 1);  // cos 27 deg
  EXPECT_NEAR(axis(6), 819 * 0.4540, 1);
  EXPECT_TRUE(motor.control({0x40, 0x06, 99, 0, 0}, {}, 0).is_stalled) << "no such LED";
}

}  // namespace
}  // namespace camloc::fakes
