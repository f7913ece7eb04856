// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See iso_stream.h.
#include "drivers/kinect/iso_stream.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <thread>

#include "drivers/kinect/kinect_usb.h"

namespace camloc::kinect {

namespace {

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

IsoStream::~IsoStream() { assert(num_in_flight_ == 0 || slots_.empty()); }

bool IsoStream::submit(libusb_transfer* transfer) {
  errno = 0;
  num_in_flight_.fetch_add(1);
  const int code = libusb_submit_transfer(transfer);
  if (code == LIBUSB_SUCCESS) return true;
  int none = 0;
  if (submit_error_.compare_exchange_strong(none, code)) submit_errno_ = errno;
  num_in_flight_.fetch_sub(1);
  if (code == LIBUSB_ERROR_NO_DEVICE) receiver_->on_gone();
  return false;
}

bool IsoStream::lacks_memory() const { return submit_error_ == LIBUSB_ERROR_NO_MEM || submit_errno_ == ENOMEM; }

void IsoStream::allocate(int packets_per_transfer, int packet_bytes) {
  packets_per_transfer_ = packets_per_transfer;
  slots_ = std::vector<Slot>(static_cast<std::size_t>(kPacketsInFlight / packets_per_transfer));
  for (Slot& slot : slots_) {
    slot.buffer.resize(static_cast<std::size_t>(packet_bytes) * static_cast<std::size_t>(packets_per_transfer));
    slot.transfer.reset(libusb_alloc_transfer(packets_per_transfer));
  }
}

Status IsoStream::submit_all(libusb_device_handle* handle, std::uint8_t endpoint, int packet_bytes) {
  is_stopping_ = false;
  submit_error_ = submit_errno_ = 0;
  for (Slot& slot : slots_) {
    if (!slot.transfer) return usb_error(LIBUSB_ERROR_NO_MEM, 0, "Kinect stream");
    libusb_fill_iso_transfer(slot.transfer.get(), handle, endpoint, slot.buffer.data(), static_cast<int>(slot.buffer.size()),
                             packets_per_transfer_, &IsoStream::on_transfer, this, 0);
    libusb_set_iso_packet_lengths(slot.transfer.get(), static_cast<unsigned>(packet_bytes));
    if (!submit(slot.transfer.get())) return usb_error(submit_error_, submit_errno_, "Kinect stream");
  }
  return Status::ok();
}

Status IsoStream::start(libusb_device_handle* handle, std::uint8_t endpoint, int packet_bytes) {
  assert(num_in_flight_ == 0);
  if (slots_.empty() || lacks_memory()) allocate(lacks_memory() ? kShortTransfer : kLongTransfer, packet_bytes);
  Status status = submit_all(handle, endpoint, packet_bytes);
  if (status || !lacks_memory() || packets_per_transfer_ == kShortTransfer || !stop(kDrainPatience)) return status;
  allocate(kShortTransfer, packet_bytes);
  return submit_all(handle, endpoint, packet_bytes);
}

bool IsoStream::stop(std::chrono::milliseconds patience) {
  is_stopping_ = true;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (num_in_flight_ > 0 && std::chrono::steady_clock::now() < deadline) {
    // Again each time: one may just have been submitted by a call-back that had not seen is_stopping_ yet.
    for (const Slot& slot : slots_) libusb_cancel_transfer(slot.transfer.get());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (num_in_flight_ == 0) return true;
  // The kernel may still write to these buffers.
  for (Slot& slot : slots_) {
    static_cast<void>(slot.transfer.release());
    new std::vector<std::uint8_t>(std::move(slot.buffer));
  }
  slots_.clear();
  return false;
}

void LIBUSB_CALL IsoStream::on_transfer(libusb_transfer* transfer) { static_cast<IsoStream*>(transfer->user_data)->handle(transfer); }

void IsoStream::handle(libusb_transfer* transfer) {
  if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) receiver_->on_gone();
  if (transfer->status == LIBUSB_TRANSFER_COMPLETED && !is_stopping_) receive(transfer);
  const bool may_go_on = transfer->status != LIBUSB_TRANSFER_NO_DEVICE && transfer->status != LIBUSB_TRANSFER_CANCELLED && !is_stopping_;
  if (may_go_on) static_cast<void>(submit(transfer));
  num_in_flight_.fetch_sub(1);
}

// Packets came one per micro-frame, and the transfer is reported when the last is there.
void IsoStream::receive(libusb_transfer* transfer) {
  const std::int64_t now_ns = monotonic_ns();
  std::size_t num_errors = 0;
  for (int i = 0; i < transfer->num_iso_packets; ++i) {
    const libusb_iso_packet_descriptor& packet = transfer->iso_packet_desc[i];
    if (packet.status != LIBUSB_TRANSFER_COMPLETED) {
      ++num_errors;
      continue;
    }
    if (packet.actual_length == 0) continue;  // nothing in this micro-frame
    const unsigned char* const bytes = libusb_get_iso_packet_buffer_simple(transfer, static_cast<unsigned>(i));
    receiver_->on_packet(stream_, {bytes, std::min(packet.actual_length, packet.length)},
                         now_ns - (transfer->num_iso_packets - 1 - i) * kPacketIntervalNs);
  }
  receiver_->on_transfer(stream_, num_errors, now_ns);
}

}  // namespace camloc::kinect
