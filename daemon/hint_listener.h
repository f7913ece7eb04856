// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hints that arrive over LCM, as camloc.pose_hint_t. Off unless control.hint_channel is set: LCM does not say who sent a message.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/localize/pose_hint.h"
#include "daemon/lcm_connection.h"

namespace camloc {

/// Older hints are dropped: the camera may be anywhere by then.
inline constexpr std::int64_t kMaxHintAge_ns = 3'000'000'000;

/// What an encoded message says. kInvalid: it is of another type, has another length, is no valid hint, is too old or from the future.
[[nodiscard]] Result<PoseHint> parse_hint_message(std::span<const std::uint8_t> bytes, std::int64_t now_epoch_ns);

/// Belongs to the daemon's main thread; LCM receives in a thread of its own.
class HintListener {
 public:
  using Handler = std::function<void(const Result<PoseHint>&)>;
  /// `on_hint` is called by handle(), also for what is refused.
  HintListener(std::string url, std::string channel, Handler on_hint);
  HintListener(const HintListener&) = delete;
  HintListener& operator=(const HintListener&) = delete;

  /// kUnavailable: try again later. Does nothing once connected.
  [[nodiscard]] Status connect();
  /// To wait for with poll(); -1 while not connected.
  [[nodiscard]] int fd() const;
  /// Takes one message; for when fd() is readable.
  void handle(std::int64_t now_epoch_ns);

 private:
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* self);

  std::string url_, channel_;
  Handler on_hint_;
  std::int64_t now_epoch_ns_ = 0;  // while in handle()
  Lcm lcm_;
};

}  // namespace camloc
