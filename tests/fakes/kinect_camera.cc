// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {
namespace {

constexpr std::size_t kCommandHeaderBytes = 8;
constexpr std::uint16_t kReadRegister = 0x02, kWriteRegister = 0x03, kFixedParameters = 0x04, kParameters = 0x16, kSensorRegister = 0x95;
constexpr std::uint16_t kVideoStream = 0x05, kDepthStream = 0x06, kVideoFormat = 0x0c, kVideoResolution = 0x0d, kVideoRate = 0x0e,
                        kDepthFormat = 0x12, kInfraredResolution = 0x1a;
constexpr std::uint16_t kVideoIsInfrared = 3, kFormatUyvy = 5, kResolutionHigh = 2, kDepth10Packed = 2;
constexpr std::uint16_t kSensorWrite = 0x8000;
constexpr std::size_t kVideoPayload = 1908, kDepthPayload = 1748;  // bytes of a frame in a packet
constexpr std::int64_t kSecond = 1'000'000'000;

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return at + 1 < bytes.size() ? static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8) : std::uint16_t{0};
}

void append_word(std::vector<std::uint8_t>* bytes, std::uint16_t value) {
  bytes->push_back(static_cast<std::uint8_t>(value));
  bytes->push_back(static_cast<std::uint8_t>(value >> 8));
}

}  // namespace

const char* name_of(StreamId stream) { return stream == StreamId::kVideo ? "video" : "depth"; }

const char* name_of(FrameFormat format) {
  switch (format) {
    case FrameFormat::kBayer: return "bayer";
    case FrameFormat::kBayerHigh: return "bayer_high";
    case FrameFormat::kUyvy: return "uyvy";
    case FrameFormat::kInfrared: return "infrared";
    case FrameFormat::kInfraredHigh: return "infrared_high";
    case FrameFormat::kDepth11: return "depth11";
    case FrameFormat::kDepth10: return "depth10";
  }
  return "";
}

std::size_t payload_bytes(FrameFormat format) {
  switch (format) {
    case FrameFormat::kBayer: return 640 * 480;
    case FrameFormat::kBayerHigh: return 1280 * 1024;
    case FrameFormat::kUyvy: return 640 * 480 * 2;
    case FrameFormat::kInfrared: return 640 * 488 * 10 / 8;
    case FrameFormat::kInfraredHigh: return 1280 * 1024 * 10 / 8;
    case FrameFormat::kDepth11: return 640 * 480 * 11 / 8;
    case FrameFormat::kDepth10: return 640 * 480 * 10 / 8;
  }
  return 0;
}

KinectCamera::KinectCamera(const KinectOptions& options, UsbDescriptors descriptors, FrameShow* show)
    : UsbFunction(std::move(descriptors)), options_(options), show_(show) {
  reset(0);
}

void KinectCamera::reset(std::int64_t /*now_ns*/) {
  registers_ = {{kVideoFormat, 0}, {kVideoResolution, 1}, {kVideoRate, 30}, {kDepthFormat, 3}, {0x13, 1}, {0x14, 30}, {0x15, 30}};
  // Aptina-like sensor: automatic exposure and white balance on, a shutter, unit gain.
  sensor_registers_ = {{0x0106, 0x700e}, {0x0009, 0x0408}, {0x0035, 0x0020}, {0x0000, 0x143a}};
  for (Stream& stream : streams_) stream.is_on = stream.in_frame = false;
  reply_.clear();
  show_start_ns_ = -1;
}

std::uint32_t KinectCamera::ticks_at(std::int64_t now_ns) const {
  const double ticks = static_cast<double>(now_ns) * (kClockHz / kSecond) * (1 + options_.clock_ppm * 1e-6);
  return static_cast<std::uint32_t>(options_.clock_start +
                                    static_cast<std::uint64_t>(static_cast<std::int64_t>(ticks) + clock_jump_ticks_));
}

std::uint16_t KinectCamera::register_value(std::uint16_t address) const {
  const auto found = registers_.find(address);
  return found == registers_.end() ? std::uint16_t{0} : found->second;
}

ControlReply KinectCamera::vendor_request(const UsbSetup& setup, std::span<const std::uint8_t> data_out, std::int64_t now_ns) {
  if (setup.request != 0) return {true, {}};
  if (!setup.is_in()) {
    accept_command(data_out, now_ns);
    return {};
  }
  if (reply_.empty() || now_ns < reply_ready_ns_) return {};
  ControlReply reply{false, std::move(reply_)};
  reply_.clear();
  return reply;
}

void KinectCamera::accept_command(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  reply_.clear();
  ++num_commands_;
  const bool is_command = bytes.size() >= kCommandHeaderBytes && bytes[0] == 'G' && bytes[1] == 'M' &&
                          kCommandHeaderBytes + 2 * std::size_t{word_at(bytes, 2)} == bytes.size();
  const auto body = is_command ? execute(word_at(bytes, 4), bytes.subspan(kCommandHeaderBytes), now_ns) : std::nullopt;
  if (!body) {
    ++num_bad_commands_;
    return;  // the device never answers
  }
  reply_ = {'R', 'B'};
  append_word(&reply_, static_cast<std::uint16_t>(body->size() / 2));
  append_word(&reply_, word_at(bytes, 4));
  append_word(&reply_, word_at(bytes, 6));
  reply_.insert(reply_.end(), body->begin(), body->end());
  reply_ready_ns_ = now_ns + options_.reply_delay_ns;
  if (reply_filter_) reply_ready_ns_ += reply_filter_(&reply_);
}

std::optional<std::vector<std::uint8_t>> KinectCamera::execute(std::uint16_t command, std::span<const std::uint8_t> arguments,
                                                               std::int64_t now_ns) {
  const std::uint16_t first = word_at(arguments, 0);
  switch (command) {
    case kReadRegister: {
      std::vector<std::uint8_t> body;
      append_word(&body, first);
      append_word(&body, register_value(first));
      return body;
    }
    case kWriteRegister:
      if (arguments.size() < 4) return std::nullopt;
      write_register(first, word_at(arguments, 2), now_ns);
      return std::vector<std::uint8_t>(2, 0);
    case kFixedParameters: return fixed_parameters_block(options_.calibration, options_.model == KinectModel::k1414 ? 322 : 334);
    case kParameters: return parameters(first);
    case kSensorRegister: return sensor_register(word_at(arguments, 2), word_at(arguments, 4));
    default: return std::nullopt;
  }
}

std::vector<std::uint8_t> KinectCamera::parameters(std::uint16_t which) const {
  switch (which) {
    case 0x40: return registration_block(options_.calibration);
    case 0x41: return padding_block();
    default: return const_shift_block(options_.calibration);
  }
}

std::vector<std::uint8_t> KinectCamera::sensor_register(std::uint16_t address, std::uint16_t value) {
  const auto plain = static_cast<std::uint16_t>(address & ~kSensorWrite);
  if ((address & kSensorWrite) != 0) sensor_registers_[plain] = value;
  std::vector<std::uint8_t> body;
  append_word(&body, 1);
  append_word(&body, address);
  append_word(&body, sensor_registers_[plain]);
  return body;
}

void KinectCamera::write_register(std::uint16_t address, std::uint16_t value, std::int64_t now_ns) {
  registers_[address] = value;
  if (address == kVideoStream) switch_stream(StreamId::kVideo, value != 0, now_ns);
  if (address == kDepthStream) switch_stream(StreamId::kDepth, value != 0, now_ns);
}

void KinectCamera::switch_stream(StreamId id, bool on, std::int64_t now_ns) {
  Stream& stream = streams_[index_of(id)];
  if (!on) {
    stream.is_on = stream.in_frame = false;
    return;
  }
  const bool other_is_on = streams_[1 - index_of(id)].is_on;
  stream.format = format_of(id);
  stream.is_on = true;
  stream.in_frame = false;
  stream.offset = 0;
  // The first whole exposure from now on: the sensors run freely, starting a stream only lets packets out.
  stream.next_exposure = now_ns / period_ns(id);
  while (exposure_ns(id, stream.next_exposure) < now_ns) ++stream.next_exposure;
  if (!other_is_on) show_start_ns_ = -1;
  if (show_start_ns_ < 0 && (other_is_on || !options_.advance_needs_both)) {
    // Depth exposes first; a colour frame belongs to the depth frame before it.
    const std::int64_t depth_period = period_ns(StreamId::kDepth);
    show_start_ns_ = (now_ns / depth_period + 1) * depth_period;
  }
}

FrameFormat KinectCamera::format_of(StreamId id) const {
  if (id == StreamId::kDepth) return register_value(kDepthFormat) == kDepth10Packed ? FrameFormat::kDepth10 : FrameFormat::kDepth11;
  if (register_value(kVideoStream) == kVideoIsInfrared)
    return register_value(kInfraredResolution) == kResolutionHigh ? FrameFormat::kInfraredHigh : FrameFormat::kInfrared;
  if (register_value(kVideoFormat) == kFormatUyvy) return FrameFormat::kUyvy;
  return register_value(kVideoResolution) == kResolutionHigh ? FrameFormat::kBayerHigh : FrameFormat::kBayer;
}

std::int64_t KinectCamera::period_ns(StreamId id) const {
  const FrameFormat format = format_of(id);
  const double hz = format == FrameFormat::kUyvy ? 15 : format == FrameFormat::kBayerHigh || format == FrameFormat::kInfraredHigh ? 9 : 30;
  return std::llround(static_cast<double>(kSecond) / hz / (1 + options_.clock_ppm * 1e-6));
}

std::int64_t KinectCamera::exposure_ns(StreamId id, std::int64_t number) const {
  return number * period_ns(id) + (id == StreamId::kVideo ? options_.video_delay_ns : 0);
}

std::uint64_t KinectCamera::show_index_at(std::int64_t time_ns) {
  const std::int64_t since_start_ns = time_ns - show_start_ns_;
  if (show_start_ns_ < 0 || since_start_ns < 0) return 0;
  return static_cast<std::uint64_t>(since_start_ns / period_ns(StreamId::kDepth));
}

bool KinectCamera::begin_frame(StreamId id, std::int64_t now_ns) {
  Stream& stream = streams_[index_of(id)];
  const std::int64_t time_ns = exposure_ns(id, stream.next_exposure);
  if (now_ns < time_ns) return false;
  stream.in_frame = true;
  stream.offset = 0;
  stream.stamp_ticks = ticks_at(time_ns);
  stream.show_index = show_index_at(time_ns);
  // A frame that takes longer to send than a period delays the next one to the next free exposure.
  while (exposure_ns(id, stream.next_exposure) <= now_ns) ++stream.next_exposure;
  return true;
}

void KinectCamera::next_packet(StreamId id, std::int64_t now_ns, IsoPacket* packet) {
  Stream& stream = streams_[index_of(id)];
  packet->size = 0;
  packet->is_first = packet->is_last = false;
  if (!stream.is_on || (!stream.in_frame && !begin_frame(id, now_ns))) return;

  const std::span<const std::uint8_t> frame = show_->frame(stream.format, stream.show_index);
  const std::size_t limit = id == StreamId::kVideo ? kVideoPayload : kDepthPayload;
  const std::size_t payload = std::min(limit, frame.size() - stream.offset);
  packet->is_first = stream.offset == 0;
  packet->is_last = stream.offset + payload == frame.size();
  packet->size = payload + kPacketHeaderBytes;
  packet->show_index = stream.show_index;
  packet->stamp_ticks = stream.stamp_ticks;
  packet->format = stream.format;

  const int kind = (id == StreamId::kVideo ? 0x80 : 0x70) + (packet->is_first ? 1 : packet->is_last ? 5 : 2);
  const std::uint32_t stamp = packet->is_first ? 0 : stream.stamp_ticks;
  const auto byte = [](std::size_t value) { return static_cast<std::uint8_t>(value); };
  const std::array<std::uint8_t, kPacketHeaderBytes> header = {'R',
                                                               'B',
                                                               0,
                                                               byte(static_cast<std::size_t>(kind)),
                                                               0,
                                                               stream.sequence,
                                                               byte(packet->size >> 8),
                                                               byte(packet->size),
                                                               byte(stamp),
                                                               byte(stamp >> 8),
                                                               byte(stamp >> 16),
                                                               byte(stamp >> 24)};
  std::copy(header.begin(), header.end(), packet->bytes.begin());
  std::memcpy(packet->bytes.data() + kPacketHeaderBytes, frame.data() + stream.offset, payload);
  ++stream.sequence;
  stream.offset += payload;
  if (packet->is_last) stream.in_frame = false;
}

}  // namespace camloc::fakes
