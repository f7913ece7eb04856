// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Time, queues and sessions. What single ioctls do is in usbfs_ioctls.cc.
#include "tests/fakes/usbfs_host.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace camloc::fakes {
namespace {

constexpr std::int64_t kMicroframeNs = 125'000;
constexpr std::int64_t kTickNs = 1'000'000;  // completions come in batches, as with a host controller's interrupts
constexpr std::int64_t kIdleNs = 20'000'000;
constexpr std::int64_t kMaxHoldNs = 100'000'000;

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

UsbfsHost::UsbfsHost(KinectRig* rig, BusPace pace, bool has_kernel_driver)
    : rig_(rig), pace_(pace), has_driver_(has_kernel_driver), is_driver_bound_(has_kernel_driver), origin_ns_(monotonic_ns()) {
  rig_->set_extra_counts([this] { return counts(); });
  thread_ = std::thread([this] { run(); });
}

UsbfsHost::~UsbfsHost() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
  rig_->set_extra_counts(nullptr);
}

void UsbfsHost::open_session(const void* key, UsbDeviceId device, pid_t pid, UniqueFd connection, ReadySink ready) {
  const std::lock_guard lock(mutex_);
  Session& session = sessions_[key] = Session{};
  session.connection = std::move(connection);
  session.device = device;
  session.pid = pid;
  session.ready = std::move(ready);
  session.ready(false);
  ++num_sessions_;
}

void UsbfsHost::close_dead_sessions() {
  std::erase_if(sessions_, [](const auto& entry) {
    pollfd state{entry.second.connection.get(), POLLRDHUP, 0};
    return !entry.second.connection.is_open() || ::poll(&state, 1, 0) > 0;
  });
}

void UsbfsHost::disconnect() {
  const std::lock_guard lock(mutex_);
  advance();
  for (auto& [key, session] : sessions_) {
    for (auto& queue : session.queued) {
      for (UrbPtr& urb : queue) {
        urb->status = -ESHUTDOWN;
        complete(&session, std::move(urb));
      }
      queue.clear();
    }
    session.is_gone = true;
    session.ready(true);  // so that a client that waits comes and learns
  }
  rig_->power_cycle(bus_ns_);
}

std::string UsbfsHost::command(std::string_view line) {
  const std::lock_guard lock(mutex_);
  advance();
  return rig_->command(line, bus_ns_);
}

std::string UsbfsHost::counts() const {
  const auto member = [](const char* name, std::uint64_t value) { return std::string("\"") + name + "\": " + std::to_string(value); };
  return "\"usbfs\": {" + member("ioctls", num_ioctls_) + ", " + member("submitted", num_submitted_) + ", " +
         member("reaped", num_reaped_) + ", " + member("discarded", num_discarded_) + ", " + member("sessions", num_sessions_) + ", " +
         member("open_sessions", sessions_.size()) + ", " + member("driver_detached", num_detached_) + ", " +
         member("driver_attached", num_attached_) + ", " + member("held_us", static_cast<std::uint64_t>(held_ns_ / 1000)) + "}";
}

void UsbfsHost::run() {
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    advance();
    const std::int64_t now = monotonic_ns();
    if (now >= next_check_ns_) {
      close_dead_sessions();
      next_check_ns_ = now + kIdleNs;
    }
    const std::int64_t due = next_due_ns() + origin_ns_ + held_ns_;
    const std::int64_t wake = std::min(std::max(due, now + kTickNs), now + kIdleNs);
    changed_.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(wake)));
  }
}

std::int64_t UsbfsHost::next_due_ns() const {
  std::int64_t due = bus_ns_ + kIdleNs;
  for (const auto& [key, session] : sessions_) {
    for (const StreamId stream : kBothStreams) {
      const auto& queue = session.queued[index_of(stream)];
      if (queue.empty()) continue;
      const std::size_t to_go = queue.front()->lengths.size() - queue.front()->next_packet;
      due = std::min(due, endpoints_[index_of(stream)].next_ns + static_cast<std::int64_t>(to_go) * kMicroframeNs);
    }
  }
  return due;
}

std::size_t UsbfsHost::queued_packets(StreamId stream) const {
  std::size_t count = 0;
  for (const auto& [key, session] : sessions_)
    for (const UrbPtr& urb : session.queued[index_of(stream)]) count += urb->lengths.size() - urb->next_packet;
  return count;
}

std::int64_t UsbfsHost::held_target(std::int64_t target_ns) {
  if (pace_ == BusPace::kRealTime) return target_ns;
  const std::int64_t now = monotonic_ns();
  std::int64_t held = target_ns;
  for (const StreamId stream : kBothStreams) {
    Endpoint& endpoint = endpoints_[index_of(stream)];
    if (!endpoint.is_listening || !rig_->is_streaming(stream)) continue;
    const std::size_t packets = queued_packets(stream);
    if (packets == 0 && now - endpoint.dry_since_ns > kMaxHoldNs) {
      endpoint.is_listening = false;
      continue;
    }
    held = std::min(held, endpoint.next_ns + static_cast<std::int64_t>(packets) * kMicroframeNs);
  }
  return std::max(held, bus_ns_);
}

void UsbfsHost::advance() {
  const std::int64_t target_ns = monotonic_ns() - origin_ns_ - held_ns_;
  const std::int64_t until_ns = held_target(target_ns);
  held_ns_ += target_ns - until_ns;
  rig_->set_monotonic_offset(origin_ns_ + held_ns_);
  for (const StreamId stream : kBothStreams) carry(stream, until_ns);
  bus_ns_ = until_ns;
}

UsbfsHost::Session* UsbfsHost::listener(StreamId stream) {
  for (auto& [key, session] : sessions_)
    if (!session.queued[index_of(stream)].empty()) return &session;
  return nullptr;
}

void UsbfsHost::carry(StreamId stream, std::int64_t until_ns) {
  Endpoint& endpoint = endpoints_[index_of(stream)];
  Session* session = listener(stream);
  if (session == nullptr && !rig_->is_streaming(stream)) {
    endpoint.next_ns = std::max(endpoint.next_ns, until_ns / kMicroframeNs * kMicroframeNs);
    return;
  }
  for (; endpoint.next_ns + kMicroframeNs <= until_ns; endpoint.next_ns += kMicroframeNs) {
    bool is_error = false;
    rig_->next_packet(stream, endpoint.next_ns, session != nullptr, &packet_, &is_error);
    if (session == nullptr) continue;
    auto& queue = session->queued[index_of(stream)];
    Urb& urb = *queue.front();
    const std::size_t i = urb.next_packet++;
    const bool is_too_long = packet_.size > urb.lengths[i];
    const std::size_t size = is_too_long ? urb.lengths[i] : packet_.size;
    urb.actual[i] = static_cast<std::uint32_t>(size);
    urb.statuses[i] = is_error ? -EILSEQ : is_too_long ? -EOVERFLOW : 0;
    urb.data.insert(urb.data.end(), packet_.bytes.begin(), packet_.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    if (urb.next_packet < urb.lengths.size()) continue;
    UrbPtr finished = std::move(queue.front());
    queue.pop_front();
    complete(session, std::move(finished));
    if (queue.empty()) {
      endpoint.dry_since_ns = monotonic_ns();
      session = listener(stream);
    }
  }
}

void UsbfsHost::complete(Session* session, UrbPtr urb) {
  session->done.push_back(std::move(urb));
  if (session->done.size() == 1) session->ready(true);
}

IoctlResult UsbfsHost::ioctl(const void* key, unsigned long request, std::uint64_t argument) {
  const std::lock_guard lock(mutex_);
  ++num_ioctls_;
  const auto found = sessions_.find(key);
  if (found == sessions_.end()) return {-1, ENODEV};
  return dispatch(&found->second, request, argument);
}

}  // namespace camloc::fakes
