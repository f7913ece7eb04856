// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/kinect_faults.h"

#include <algorithm>

#include "core/io/text.h"

namespace camloc::fakes {
namespace {

constexpr std::array<const char*, kNumFaults> kFaultNames = {
    "loss",     "bus_error",  "duplicate",     "reorder",    "short",    "sequence_jump", "bad_magic",   "bad_kind",
    "bad_size", "clock_jump", "control_stall", "late_reply", "no_reply", "wrong_tag",     "wrong_magic", "short_reply"};
constexpr std::int64_t kLateNs = 50'000'000;
constexpr std::int64_t kNeverNs = std::int64_t{1} << 60;

}  // namespace

const char* name_of(Fault fault) { return kFaultNames[static_cast<std::size_t>(fault)]; }

Result<Fault> parse_fault(std::string_view name) {
  const auto found = std::find(kFaultNames.begin(), kFaultNames.end(), name);
  if (found != kFaultNames.end()) return static_cast<Fault>(found - kFaultNames.begin());
  std::string known;
  for (const char* const each : kFaultNames) known += std::string(" ") + each;
  return {ErrorCode::kInvalid, "no fault is called " + in_quotes(name) + "; known:" + known};
}

Status FaultInjector::configure(std::string_view spec) {
  const std::size_t at = spec.find_first_of("=:");
  if (at == std::string_view::npos)
    return {ErrorCode::kInvalid, "fault " + in_quotes(spec) + " is neither KIND=PROBABILITY nor KIND:TIMES"};
  const auto fault = parse_fault(spec.substr(0, at));
  if (!fault) return fault.status();
  const std::string_view text = spec.substr(at + 1);
  if (spec[at] == '=') {
    const auto probability = parse_double(text);
    if (!probability || !(*probability >= 0 && *probability <= 1))
      return {ErrorCode::kInvalid, "not a probability in [0, 1]: " + in_quotes(text)};
    set_probability(*fault, *probability);
    return {};
  }
  const auto times = parse_int(text);
  if (!times || *times < 0) return {ErrorCode::kInvalid, "not a number of times: " + in_quotes(text)};
  add_strikes(*fault, static_cast<std::uint64_t>(*times));
  return {};
}

std::uint64_t FaultInjector::random() {
  // SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
  std::uint64_t z = random_state_ += 0x9e3779b97f4a7c15U;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9U;
  z = (z ^ z >> 27) * 0x94d049bb133111ebU;
  return z ^ z >> 31;
}

bool FaultInjector::strikes(Fault fault) {
  Plan& plan = this->plan(fault);
  if (plan.strikes > 0) {
    --plan.strikes;
  } else if (plan.probability <= 0 || static_cast<double>(random() >> 11) * 0x1p-53 >= plan.probability) {
    return false;
  }
  ++plan.count;
  return true;
}

bool FaultInjector::damage_packet(StreamId stream, KinectCamera* camera, IsoPacket* packet, bool* is_error) {
  const auto garbage = [&] { return static_cast<std::uint8_t>(1 + random_below(255)); };
  bool is_damaged = true;
  if (strikes(Fault::kLoss)) {
    packet->size = 0;
  } else if (strikes(Fault::kBusError)) {
    packet->size = 0;
    *is_error = true;
  } else if (strikes(Fault::kShort)) {
    packet->size = random_below(packet->size);
  } else if (strikes(Fault::kBadMagic)) {
    packet->bytes[random_below(2)] ^= garbage();
  } else if (strikes(Fault::kBadKind)) {
    packet->bytes[3] = static_cast<std::uint8_t>(packet->bytes[3] ^ (0x08 | random_below(8)));
  } else if (strikes(Fault::kBadSize)) {
    packet->bytes[6 + random_below(2)] ^= garbage();
  } else {
    is_damaged = false;
  }
  if (strikes(Fault::kSequenceJump)) {
    camera->skip_sequence(stream, static_cast<int>(1 + random_below(200)));
    is_damaged = true;
  }
  if (strikes(Fault::kClockJump))
    camera->jump_clock(static_cast<std::int64_t>(random_below(2 * static_cast<std::size_t>(kClockHz))) -
                       static_cast<std::int64_t>(kClockHz));
  return is_damaged;
}

bool FaultInjector::filter_packet(StreamId stream, KinectCamera* camera, IsoPacket* packet, bool* is_error) {
  constexpr std::size_t kMaxWaiting = 64;  // more would outlast the gap between frames
  std::deque<IsoPacket>& waiting = waiting_[index_of(stream)];
  bool& is_held = is_held_[index_of(stream)];
  *is_error = false;
  bool is_damaged = false;
  if (packet->size > 0) {
    is_damaged = damage_packet(stream, camera, packet, is_error);
    if (*is_error) return true;
    const bool fits = packet->size > 0 && waiting.size() < kMaxWaiting;
    if (is_held) {
      waiting.insert(waiting.end() - 1, *packet);
      is_held = false;
      packet->size = 0;
    } else if (fits && strikes(Fault::kReorder)) {
      waiting.push_back(*packet);
      is_held = is_damaged = true;
      packet->size = 0;
    } else if (fits && strikes(Fault::kDuplicate)) {
      waiting.push_back(*packet);
      waiting.push_back(*packet);
      is_damaged = true;
      packet->size = 0;
    } else if (!waiting.empty()) {
      waiting.push_back(*packet);
      packet->size = 0;
    }
  }
  if (waiting.empty() || packet->size > 0) return is_damaged;
  if (is_held && waiting.size() == 1) return is_damaged;
  *packet = waiting.front();
  waiting.pop_front();
  return is_damaged;
}

std::int64_t FaultInjector::filter_reply(std::vector<std::uint8_t>* reply) {
  if (strikes(Fault::kNoReply)) return kNeverNs;
  if (strikes(Fault::kWrongTag)) reply->at(6) ^= static_cast<std::uint8_t>(1 + random_below(255));
  if (strikes(Fault::kWrongMagic)) reply->at(0) ^= static_cast<std::uint8_t>(1 + random_below(255));
  if (strikes(Fault::kShortReply)) reply->resize(1 + random_below(reply->size() - 1));
  return strikes(Fault::kLateReply) ? kLateNs : 0;
}

Result<BadDescriptors> parse_bad_descriptors(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames = {"none", "no-endpoints", "truncated", "bulk-endpoints", "small-packets", "empty"};
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<BadDescriptors>(found - kNames.begin());
  return {ErrorCode::kInvalid,
          "descriptors " + in_quotes(name) + ": not one of none no-endpoints truncated bulk-endpoints small-packets empty"};
}

void spoil(BadDescriptors kind, UsbDescriptors* descriptors) {
  constexpr std::size_t kNumEndpointsAt = 9 + 4, kFirstEndpoint = 18, kSecondEndpoint = 25, kAttributes = 3, kMaxPacket = 4;
  std::vector<std::uint8_t>& bytes = descriptors->configuration;
  switch (kind) {
    case BadDescriptors::kNone: break;
    case BadDescriptors::kNoEndpoints:
      bytes.resize(kFirstEndpoint);
      bytes[2] = static_cast<std::uint8_t>(bytes.size());
      bytes[kNumEndpointsAt] = 0;
      break;
    case BadDescriptors::kTruncated: bytes.resize(kFirstEndpoint + 3); break;
    case BadDescriptors::kBulkEndpoints: bytes[kFirstEndpoint + kAttributes] = bytes[kSecondEndpoint + kAttributes] = 2; break;
    case BadDescriptors::kSmallPackets:
      bytes[kFirstEndpoint + kMaxPacket + 1] = bytes[kSecondEndpoint + kMaxPacket + 1] = 0;  // 192 bytes
      break;
    case BadDescriptors::kEmpty: bytes.clear(); break;
  }
}

}  // namespace camloc::fakes
