// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/hint_listener.h"

#include <utility>

#include "camloc/pose_hint_t.hpp"

namespace camloc {

Result<PoseHint> parse_hint_message(std::span<const std::uint8_t> bytes, std::int64_t now_epoch_ns) {
  pose_hint_t message{};
  const int size = std::in_range<int>(bytes.size()) ? static_cast<int>(bytes.size()) : 0;
  if (size == 0 || message.decode(bytes.data(), 0, size) != size) return Status(ErrorCode::kInvalid, "it is no camloc.pose_hint_t");
  constexpr std::int64_t kMaxAge_us = kMaxHintAge_ns / 1000, kMaxLead_us = 1'000'000;
  const std::int64_t now_us = now_epoch_ns / 1000;
  if (message.utime < now_us - kMaxAge_us) return Status(ErrorCode::kInvalid, "it is too old; utime is microseconds since the epoch");
  if (message.utime > now_us + kMaxLead_us)
    return Status(ErrorCode::kInvalid, "it is from the future; utime is microseconds since the epoch");
  PoseHint hint;
  hint.position_m = {message.pos[0], message.pos[1], message.pos[2]};
  hint.yaw_rad = message.yaw_rad;
  hint.radius_m = message.radius_m;
  if (!hint.is_valid()) return Status(ErrorCode::kInvalid, "the radius is to be above 0 and at most 20 m, and every number finite");
  return hint;
}

HintListener::HintListener(std::string url, std::string channel, Handler on_hint)
    : url_(std::move(url)), channel_(std::move(channel)), on_hint_(std::move(on_hint)) {}

Status HintListener::connect() {
  if (lcm_) return Status::ok();
  Result<Lcm> lcm = connect_lcm(url_);
  if (!lcm) return lcm.status();
  lcm_subscription_t* subscription = lcm_subscribe(lcm->get(), channel_.c_str(), &HintListener::on_message, this);
  if (subscription == nullptr) return {ErrorCode::kUnavailable, "LCM does not subscribe to " + channel_};
  lcm_subscription_set_queue_capacity(subscription, 1);
  lcm_ = std::move(lcm).value();
  return Status::ok();
}

int HintListener::fd() const { return lcm_ ? lcm_get_fileno(lcm_.get()) : -1; }

void HintListener::handle(std::int64_t now_epoch_ns) {
  now_epoch_ns_ = now_epoch_ns;
  lcm_handle_timeout(lcm_.get(), 0);
}

// A subscription is a regular expression, which may match other channels.
void HintListener::on_message(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
  auto& listener = *static_cast<HintListener*>(self);
  if (listener.channel_ != channel) return;
  listener.on_hint_(parse_hint_message({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size}, listener.now_epoch_ns_));
}

}  // namespace camloc
