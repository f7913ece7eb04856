// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Faults between the device and its host, each with a probability or as a number of times to come, from a seeded generator, and each
// counted. Packets: what arrives may be missing, doubled, out of order, cut, damaged. Replies: refused, late, missing, another's.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "tests/fakes/kinect_model.h"

namespace camloc::fakes {

enum class Fault {
  kLoss,          ///< the packet does not arrive, its microframe is empty
  kBusError,      ///< the same, and the host controller reports a CRC error (EILSEQ)
  kDuplicate,     ///< the packet arrives twice
  kReorder,       ///< the packet arrives after the next one
  kShort,         ///< the packet is cut somewhere
  kSequenceJump,  ///< sequence numbers from here on are up to 200 too high
  kBadMagic,      ///< a header that does not begin with "RB"
  kBadKind,       ///< a header with an unknown kind of packet
  kBadSize,       ///< a header that gives another size
  kClockJump,     ///< the device's clock jumps by up to a second
  kControlStall,  ///< a vendor request is refused
  kLateReply,     ///< a reply takes 50 ms longer
  kNoReply,       ///< a command is never answered
  kWrongTag,      ///< a reply to another command
  kWrongMagic,    ///< a reply that does not begin with "RB"
  kShortReply,    ///< a reply that is cut somewhere
  kNumFaults
};
inline constexpr std::size_t kNumFaults = static_cast<std::size_t>(Fault::kNumFaults);
[[nodiscard]] const char* name_of(Fault fault);  ///< as on the command line: "loss", "bus_error", ...
[[nodiscard]] Result<Fault> parse_fault(std::string_view name);

class FaultInjector {
 public:
  explicit FaultInjector(std::uint64_t seed) : random_state_(seed) {}

  void set_probability(Fault fault, double probability) { plan(fault).probability = probability; }
  /// The next `times` occasions.
  void add_strikes(Fault fault, std::uint64_t times) { plan(fault).strikes += times; }
  /// "KIND=PROBABILITY" or "KIND:TIMES".
  [[nodiscard]] Status configure(std::string_view spec);
  [[nodiscard]] std::uint64_t count(Fault fault) const { return plans_[static_cast<std::size_t>(fault)].count; }

  /// What arrives in this microframe instead of what was sent. `is_error`: the controller reports an error for it. Returns whether
  /// anything was done to a packet.
  [[nodiscard]] bool filter_packet(StreamId stream, KinectCamera* camera, IsoPacket* packet, bool* is_error);
  /// Whether to refuse this vendor request.
  [[nodiscard]] bool refuses_control() { return strikes(Fault::kControlStall); }
  /// For KinectCamera::set_reply_filter.
  [[nodiscard]] std::int64_t filter_reply(std::vector<std::uint8_t>* reply);

 private:
  struct Plan {
    double probability = 0;
    std::uint64_t strikes = 0;
    std::uint64_t count = 0;
  };

  [[nodiscard]] Plan& plan(Fault fault) { return plans_[static_cast<std::size_t>(fault)]; }
  [[nodiscard]] bool strikes(Fault fault);
  [[nodiscard]] std::uint64_t random();
  [[nodiscard]] std::size_t random_below(std::size_t bound) { return static_cast<std::size_t>(random() % bound); }
  [[nodiscard]] bool damage_packet(StreamId stream, KinectCamera* camera, IsoPacket* packet, bool* is_error);

  std::array<Plan, kNumFaults> plans_{};
  std::uint64_t random_state_;
  std::array<std::deque<IsoPacket>, 2> waiting_;  ///< a doubled or held packet pushes those behind it back
  std::array<bool, 2> is_held_{};                 ///< the last one waiting goes after the next
};

enum class BadDescriptors { kNone, kNoEndpoints, kTruncated, kBulkEndpoints, kSmallPackets, kEmpty };
[[nodiscard]] Result<BadDescriptors> parse_bad_descriptors(std::string_view name);
/// Spoils a camera's configuration descriptor.
void spoil(BadDescriptors kind, UsbDescriptors* descriptors);

}  // namespace camloc::fakes
