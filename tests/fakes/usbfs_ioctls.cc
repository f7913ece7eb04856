// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One function an ioctl of usbfs. A client's memory is read and written with process_vm_readv and process_vm_writev: a parent may, and
// it costs one call where copying through umockdev's socket costs many.
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "tests/fakes/usbfs_host.h"

namespace camloc::fakes {
namespace {

static_assert(sizeof(void*) == 8, "URBs of 32-bit clients look different");

constexpr IoctlResult failed(int error) { return {-1, error}; }
constexpr std::size_t kSetupBytes = 8;
constexpr std::size_t kMaxControlBytes = 4096;
constexpr std::int32_t kMaxIsoPackets = 128;
constexpr const char* kDriverName = "gspca_kinect";

void* pointer(std::uint64_t address) { return reinterpret_cast<void*>(address); }

bool read_memory(pid_t pid, std::uint64_t address, void* to, std::size_t size) {
  const iovec local{to, size}, remote{pointer(address), size};
  return ::process_vm_readv(pid, &local, 1, &remote, 1, 0) == static_cast<ssize_t>(size);
}

bool write_memory(pid_t pid, std::uint64_t address, const void* from, std::size_t size) {
  const iovec local{const_cast<void*>(from), size}, remote{pointer(address), size};
  return ::process_vm_writev(pid, &local, 1, &remote, 1, 0) == static_cast<ssize_t>(size);
}

/// The kernel carries only what the descriptors announce.
bool has_iso_endpoint(const UsbDescriptors& descriptors, int address) {
  constexpr std::uint8_t kEndpointDescriptor = 5, kIsochronous = 1, kTypeMask = 3;
  const std::vector<std::uint8_t>& bytes = descriptors.configuration;
  for (std::size_t at = 0; at + 4 <= bytes.size() && bytes[at] > 0; at += bytes[at])
    if (bytes[at + 1] == kEndpointDescriptor && bytes[at + 2] == address && (bytes[at + 3] & kTypeMask) == kIsochronous) return true;
  return false;
}

}  // namespace

IoctlResult UsbfsHost::dispatch(Session* session, unsigned long request, std::uint64_t argument) {
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) return reap(session, argument);
  if (session->is_gone) return failed(ENODEV);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      const std::uint32_t caps =
          USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return write_memory(session->pid, argument, &caps, sizeof caps) ? IoctlResult{} : failed(EFAULT);
    }
    case USBDEVFS_GET_SPEED: return {3, 0};  // high speed
    case USBDEVFS_CLAIMINTERFACE: return claim(session);
    case USBDEVFS_RELEASEINTERFACE: session->has_claimed = false; return {};
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP: return {};
    case USBDEVFS_RESET:
      drop_urbs(session);
      rig_->device(session->device).reset(bus_ns_);
      return {};
    case USBDEVFS_GETDRIVER: return get_driver(session, argument);
    case USBDEVFS_IOCTL: return driver_ioctl(session, argument);
    case USBDEVFS_DISCONNECT_CLAIM: return disconnect_claim(session);
    case USBDEVFS_SUBMITURB: return submit(session, argument);
    case USBDEVFS_DISCARDURB: return discard(session, argument);
    default: return failed(ENOTTY);
  }
}

IoctlResult UsbfsHost::claim(Session* session) {
  if (session->has_claimed) return {};
  if (is_driver_bound_ && session->device == UsbDeviceId::kCamera) return failed(EBUSY);
  for (const auto& [key, other] : sessions_)
    if (!other.is_gone && other.has_claimed && other.device == session->device) return failed(EBUSY);
  session->has_claimed = true;
  return {};
}

IoctlResult UsbfsHost::get_driver(Session* session, std::uint64_t argument) {
  if (session->device != UsbDeviceId::kCamera || (!is_driver_bound_ && !session->has_claimed)) return failed(ENODATA);
  usbdevfs_getdriver answer{};
  std::strncpy(answer.driver, is_driver_bound_ ? kDriverName : "usbfs", sizeof answer.driver - 1);
  return write_memory(session->pid, argument, &answer, sizeof answer) ? IoctlResult{} : failed(EFAULT);
}

IoctlResult UsbfsHost::driver_ioctl(Session* session, std::uint64_t argument) {
  usbdevfs_ioctl command{};
  if (!read_memory(session->pid, argument, &command, sizeof command)) return failed(EFAULT);
  const bool is_disconnect = command.ioctl_code == static_cast<int>(USBDEVFS_DISCONNECT);
  if (!is_disconnect && command.ioctl_code != static_cast<int>(USBDEVFS_CONNECT)) return failed(ENOTTY);
  const bool has_driver = has_driver_ && session->device == UsbDeviceId::kCamera;
  if (is_disconnect && !(has_driver && is_driver_bound_)) return failed(ENODATA);
  if (is_disconnect) {
    is_driver_bound_ = false;
    ++num_detached_;
    return {};
  }
  if (session->has_claimed || is_driver_bound_) return failed(EBUSY);
  if (!has_driver) return {};  // no driver took the interface
  is_driver_bound_ = true;
  ++num_attached_;
  return {1, 0};
}

IoctlResult UsbfsHost::disconnect_claim(Session* session) {
  if (is_driver_bound_ && session->device == UsbDeviceId::kCamera) {
    is_driver_bound_ = false;
    ++num_detached_;
  }
  return claim(session);
}

IoctlResult UsbfsHost::submit(Session* session, std::uint64_t argument) {
  usbdevfs_urb header{};
  if (!read_memory(session->pid, argument, &header, sizeof header)) return failed(EFAULT);
  ++num_submitted_;
  UrbPtr urb;
  if (spare_.empty()) {
    urb = std::make_unique<Urb>();
  } else {
    urb = std::move(spare_.back());
    spare_.pop_back();
  }
  urb->address = argument;
  urb->buffer = reinterpret_cast<std::uint64_t>(header.buffer);
  urb->next_packet = 0;
  urb->status = 0;
  urb->actual_length = 0;
  urb->data.clear();
  urb->is_iso = header.type == USBDEVFS_URB_TYPE_ISO;
  if (urb->is_iso) return submit_iso(session, std::move(urb), header.endpoint, header.number_of_packets);
  if (header.type == USBDEVFS_URB_TYPE_CONTROL) return submit_control(session, std::move(urb), header.buffer_length);
  return failed(EINVAL);
}

IoctlResult UsbfsHost::submit_control(Session* session, UrbPtr urb, std::int32_t buffer_length) {
  if (buffer_length < static_cast<std::int32_t>(kSetupBytes) || buffer_length > static_cast<std::int32_t>(kMaxControlBytes))
    return failed(EINVAL);
  std::array<std::uint8_t, kMaxControlBytes> bytes;
  const auto size = static_cast<std::size_t>(buffer_length);
  if (!read_memory(session->pid, urb->buffer, bytes.data(), size)) return failed(EFAULT);
  const UsbSetup setup = parse_setup(bytes);
  if (kSetupBytes + setup.length > size) return failed(EINVAL);

  advance();
  const ControlReply reply =
      rig_->control(session->device, setup, std::span(bytes).subspan(kSetupBytes, setup.is_in() ? 0 : setup.length), bus_ns_);
  urb->status = reply.is_stalled ? -EPIPE : 0;
  urb->data_skip = kSetupBytes;
  if (!reply.is_stalled) {
    urb->data = reply.data;
    urb->actual_length = static_cast<std::int32_t>(setup.is_in() ? reply.data.size() : setup.length);
  }
  complete(session, std::move(urb));
  return {};
}

IoctlResult UsbfsHost::submit_iso(Session* session, UrbPtr urb, int endpoint, std::int32_t num_packets) {
  constexpr int kVideoEndpoint = 0x81, kDepthEndpoint = 0x82;
  if (session->device != UsbDeviceId::kCamera || (endpoint != kVideoEndpoint && endpoint != kDepthEndpoint)) return failed(ENOENT);
  if (!session->has_claimed || !has_iso_endpoint(rig_->device(session->device).descriptors(), endpoint)) return failed(ENOENT);
  if (num_packets < 1 || num_packets > kMaxIsoPackets) return failed(EINVAL);
  const auto count = static_cast<std::size_t>(num_packets);
  std::array<usbdevfs_iso_packet_desc, static_cast<std::size_t>(kMaxIsoPackets)> packets;
  if (!read_memory(session->pid, urb->address + offsetof(usbdevfs_urb, iso_frame_desc), packets.data(), count * sizeof packets[0]))
    return failed(EFAULT);
  urb->lengths.resize(count);
  for (std::size_t i = 0; i < count; ++i) urb->lengths[i] = packets[i].length;
  urb->actual.assign(count, 0);
  urb->statuses.assign(count, -EXDEV);  // what a packet says that the bus never came to
  urb->data_skip = 0;

  const StreamId stream = endpoint == kVideoEndpoint ? StreamId::kVideo : StreamId::kDepth;
  Endpoint& state = endpoints_[index_of(stream)];
  if (listener(stream) == nullptr) {
    advance();
    state.next_ns = std::max(state.next_ns, bus_ns_);
  }
  state.is_listening = true;
  session->queued[index_of(stream)].push_back(std::move(urb));
  if (session->queued[index_of(stream)].size() == 1) changed_.notify_all();
  return {};
}

IoctlResult UsbfsHost::discard(Session* session, std::uint64_t argument) {
  advance();
  for (const StreamId stream : kBothStreams) {
    auto& queue = session->queued[index_of(stream)];
    const auto found = std::find_if(queue.begin(), queue.end(), [&](const UrbPtr& urb) { return urb->address == argument; });
    if (found == queue.end()) continue;
    UrbPtr urb = std::move(*found);
    queue.erase(found);
    urb->status = -ENOENT;
    endpoints_[index_of(stream)].is_listening = false;
    ++num_discarded_;
    complete(session, std::move(urb));
    return {};
  }
  return failed(EINVAL);
}

void UsbfsHost::drop_urbs(Session* session) {
  for (auto& queue : session->queued) {
    for (UrbPtr& urb : queue) {
      urb->status = -ENOENT;
      complete(session, std::move(urb));
    }
    queue.clear();
  }
}

IoctlResult UsbfsHost::reap(Session* session, std::uint64_t argument) {
  if (session->done.empty()) {
    session->ready(false);
    return failed(session->is_gone ? ENODEV : EAGAIN);
  }
  UrbPtr urb = std::move(session->done.front());
  session->done.pop_front();
  ++num_reaped_;
  const bool is_delivered = deliver(*session, *urb) && write_memory(session->pid, argument, &urb->address, sizeof urb->address);
  if (session->done.empty()) session->ready(session->is_gone);
  constexpr std::size_t kMaxSpare = 512;
  if (spare_.size() < kMaxSpare) spare_.push_back(std::move(urb));
  return is_delivered ? IoctlResult{} : failed(EFAULT);
}

bool UsbfsHost::deliver(const Session& session, const Urb& urb) {
  struct Outcome {  // as in usbdevfs_urb, from `actual_length` on
    std::int32_t actual_length, start_frame, number_of_packets, error_count;
  };
  std::array<iovec, kMaxIsoPackets + 4> local, remote;
  std::array<usbdevfs_iso_packet_desc, static_cast<std::size_t>(kMaxIsoPackets)> packets;
  std::size_t n = 0;
  const auto add = [&](std::uint64_t address, const void* from, std::size_t size) {
    if (size == 0) return;
    local[n] = {const_cast<void*>(from), size};
    remote[n++] = {pointer(address), size};
  };

  Outcome outcome{urb.actual_length, 0, static_cast<std::int32_t>(urb.is_iso ? urb.lengths.size() : 0), 0};
  if (!urb.is_iso) {
    add(urb.buffer + urb.data_skip, urb.data.data(), urb.data.size());
  } else {
    std::uint64_t at = 0, taken = 0;
    for (std::size_t i = 0; i < urb.lengths.size(); ++i) {
      packets[i] = {urb.lengths[i], urb.actual[i], static_cast<unsigned>(urb.statuses[i])};
      if (urb.statuses[i] != 0) ++outcome.error_count;
      add(urb.buffer + at, urb.data.data() + taken, urb.actual[i]);
      at += urb.lengths[i];
      taken += urb.actual[i];
      outcome.actual_length += static_cast<std::int32_t>(urb.actual[i]);
    }
    add(urb.address + offsetof(usbdevfs_urb, iso_frame_desc), packets.data(), urb.lengths.size() * sizeof packets[0]);
  }
  add(urb.address + offsetof(usbdevfs_urb, status), &urb.status, sizeof urb.status);
  add(urb.address + offsetof(usbdevfs_urb, actual_length), &outcome, sizeof outcome);
  ssize_t total = 0;
  for (std::size_t i = 0; i < n; ++i) total += static_cast<ssize_t>(local[i].iov_len);
  return ::process_vm_writev(session.pid, local.data(), n, remote.data(), n, 0) == total;
}

}  // namespace camloc::fakes
