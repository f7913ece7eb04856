// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_receiver.h"

#include <algorithm>
#include <cassert>

namespace camloc::kinect {

KinectReceiver::Channel::Channel(const StreamLayout& layout) : assembler(layout) {
  for (RawFrame& frame : frames) frame.bytes.resize(layout.frame_bytes);
  free.reserve(kNumFrames);
  waiting.reserve(kNumFrames);
  for (std::size_t i = 1; i < kNumFrames; ++i) free.push_back(&frames[i]);
  write_to(&frames[0]);
}

void KinectReceiver::Channel::write_to(RawFrame* frame) {
  writing = frame;
  assembler.set_target(frame->bytes);
}

KinectReceiver::KinectReceiver() : channels_{std::make_unique<Channel>(color_layout()), std::make_unique<Channel>(depth_layout())} {}

void KinectReceiver::on_packet(Stream stream, std::span<const std::uint8_t> packet, std::int64_t arrival_ns) {
  Channel& c = channel(stream);
  c.packet_ns = arrival_ns;
  if (c.assembler.push(packet, arrival_ns) == PacketResult::kFrameComplete) publish(stream);
}

void KinectReceiver::publish(Stream stream) {
  Channel& c = channel(stream);
  c.writing->device_stamp = c.assembler.stamp();
  c.writing->arrival_ns = c.assembler.first_arrival_ns();
  c.writing->complete_ns = c.packet_ns;
  RawFrame* next = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (c.free.empty()) {  // nobody took the oldest in time
      c.free.push_back(c.waiting.front());
      c.waiting.erase(c.waiting.begin());
      ++report_.frames_overwritten;
    }
    next = c.free.back();
    c.free.pop_back();
    c.waiting.push_back(c.writing);
    ++num_events_;
  }
  c.write_to(next);
  changed_.notify_one();
}

void KinectReceiver::on_transfer(Stream stream, std::size_t num_errors, std::int64_t now_ns) {
  const Channel& c = channel(stream);
  const auto index = static_cast<std::size_t>(stream);
  bool is_news = false;
  {
    const std::lock_guard lock(mutex_);
    is_news = c.assembler.counts().frames_incomplete != report_.counts[index].frames_incomplete;
    num_events_ += is_news ? 1 : 0;
    report_.counts[index] = c.assembler.counts();
    report_.transport_errors[index] += num_errors;
    if (c.packet_ns != 0) report_.last_packet_ns[index] = std::min(c.packet_ns, now_ns);
  }
  if (is_news) changed_.notify_one();
}

void KinectReceiver::on_gone() {
  {
    const std::lock_guard lock(mutex_);
    report_.is_gone = true;
  }
  changed_.notify_one();
}

RawFrame* KinectReceiver::take(Stream stream) {
  Channel& c = channel(stream);
  const std::lock_guard lock(mutex_);
  num_seen_ = num_events_;
  if (c.waiting.empty()) return nullptr;
  RawFrame* const frame = c.waiting.front();
  c.waiting.erase(c.waiting.begin());
  return frame;
}

void KinectReceiver::release(Stream stream, RawFrame* frame) {
  Channel& c = channel(stream);
  const std::lock_guard lock(mutex_);
  assert(c.free.size() < kNumFrames);
  c.free.push_back(frame);
}

void KinectReceiver::wait_until(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [this] { return report_.is_gone || num_events_ != num_seen_; });
}

ReceiverReport KinectReceiver::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

void KinectReceiver::restart() {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < kNumStreams; ++i) {
    Channel& c = *channels_[i];
    c.assembler.resynchronize();
    c.packet_ns = 0;
    c.free.insert(c.free.end(), c.waiting.rbegin(), c.waiting.rend());
    c.waiting.clear();
    report_.counts[i] = c.assembler.counts();
  }
  report_.last_packet_ns = {};
}

}  // namespace camloc::kinect
