// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_device.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <utility>

#include "drivers/device_clock.h"

namespace camloc::kinect {

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
  const auto on_transfer = [](libusb_transfer* transfer) { static_cast<IsoStream*>(transfer->user_data)->handle(transfer); };
  is_stopping_ = false;
  submit_error_ = submit_errno_ = 0;
  for (Slot& slot : slots_) {
    if (!slot.transfer) return usb_error(LIBUSB_ERROR_NO_MEM, 0, "Kinect stream");
    libusb_fill_iso_transfer(slot.transfer.get(), handle, endpoint, slot.buffer.data(), static_cast<int>(slot.buffer.size()),
                             packets_per_transfer_, on_transfer, this, 0);
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

void IsoStream::handle(libusb_transfer* transfer) {
  if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) receiver_->on_gone();
  if (transfer->status == LIBUSB_TRANSFER_COMPLETED && !is_stopping_) receive(transfer);
  const bool may_go_on = transfer->status != LIBUSB_TRANSFER_NO_DEVICE && transfer->status != LIBUSB_TRANSFER_CANCELLED && !is_stopping_;
  if (may_go_on) static_cast<void>(submit(transfer));
  num_in_flight_.fetch_sub(1);
}

// Packets came one per micro-frame, and the transfer is reported when the last is there.
void IsoStream::receive(libusb_transfer* transfer) {
  const std::int64_t now_ns = steady_now_ns();
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

KinectDevice::KinectDevice(UsbContext context, OpenCamera camera, const StreamSetting& setting, KinectReceiver* receiver)
    : context_(std::move(context)),
      camera_(std::move(camera)),
      setting_(setting),
      color_(Stream::kColor, receiver),
      depth_(Stream::kDepth, receiver) {}

Result<std::unique_ptr<KinectDevice>> KinectDevice::open(const std::string& selector, KinectReceiver* receiver) {
  libusb_context* context = nullptr;
  if (const int code = libusb_init(&context); code != LIBUSB_SUCCESS) return usb_error(code, errno, "USB");
  UsbContext owner(context);
  libusb_set_option(context, LIBUSB_OPTION_LOG_LEVEL, LIBUSB_LOG_LEVEL_NONE);
  Result<OpenCamera> camera = open_camera(context, selector);
  if (!camera) return camera.status();
  const Result<StreamSetting> setting = find_stream_setting(libusb_get_device(camera->handle.get()));
  if (!setting) return setting.status();
  std::unique_ptr<KinectDevice> device(new KinectDevice(std::move(owner), std::move(camera).value(), *setting, receiver));
  if (Status status = device->claim(); !status) return status;
  device->event_thread_ = std::thread([raw = device.get()] { raw->handle_events(); });
  return device;
}

// gspca_kinect takes the camera as soon as it is plugged in.
Status KinectDevice::claim() {
  libusb_device_handle* const handle = camera_.handle.get();
  libusb_set_auto_detach_kernel_driver(handle, 1);
  errno = 0;
  int code = libusb_claim_interface(handle, kCameraInterface);
  if (code == LIBUSB_SUCCESS) {
    is_claimed_ = true;
    if (setting_.alternate != 0) code = libusb_set_interface_alt_setting(handle, kCameraInterface, setting_.alternate);
  }
  return code == LIBUSB_SUCCESS ? Status::ok() : usb_error(code, errno, "Kinect camera at " + camera_.location);
}

KinectDevice::~KinectDevice() {
  stop_transfers();
  should_stop_ = true;
  libusb_interrupt_event_handler(context_.get());
  if (event_thread_.joinable()) event_thread_.join();
  if (is_claimed_) libusb_release_interface(camera_.handle.get(), kCameraInterface);
}

void KinectDevice::handle_events() {
  while (!should_stop_) {
    timeval timeout{0, 100'000};
    if (libusb_handle_events_timeout_completed(context_.get(), &timeout, nullptr) != LIBUSB_SUCCESS) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // an error must not become a busy loop
    }
  }
}

Status KinectDevice::start_transfers(bool with_depth) {
  Status status = color_.start(camera_.handle.get(), kColorEndpoint, setting_.color_packet_bytes);
  if (status && with_depth) status = depth_.start(camera_.handle.get(), kDepthEndpoint, setting_.depth_packet_bytes);
  if (!status) stop_transfers();
  return status;
}

void KinectDevice::stop_transfers() {
  static_cast<void>(color_.stop(IsoStream::kDrainPatience));
  static_cast<void>(depth_.stop(IsoStream::kDrainPatience));
}

Status KinectDevice::transfer_problem() const {
  for (const IsoStream* stream : {&color_, &depth_}) {
    if (stream->submit_error() != 0) return usb_error(stream->submit_error(), stream->submit_errno(), "Kinect stream");
  }
  return Status::ok();
}

Status KinectDevice::reset() {
  stop_transfers();
  errno = 0;
  const int code = libusb_reset_device(camera_.handle.get());
  // Not found: it came back as another device, which is what a reset is for.
  if (code == LIBUSB_SUCCESS || code == LIBUSB_ERROR_NOT_FOUND) return Status::ok();
  return usb_error(code, errno, "Kinect reset");
}

Status KinectDevice::send(std::span<const std::uint8_t> request) {
  errno = 0;
  // libusb takes no const pointer, but writes to the data of IN requests only.
  const int sent = libusb_control_transfer(camera_.handle.get(), kVendorOut, 0, 0, 0, const_cast<unsigned char*>(request.data()),
                                           static_cast<std::uint16_t>(request.size()), kControlTimeoutMs);
  if (sent < 0) return usb_error(sent, errno, "USB control transfer");
  if (static_cast<std::size_t>(sent) != request.size()) return {ErrorCode::kCorrupt, "USB control transfer: the device took only a part"};
  return Status::ok();
}

Result<std::size_t> KinectDevice::receive(std::span<std::uint8_t> reply) {
  errno = 0;
  const int received = libusb_control_transfer(camera_.handle.get(), kVendorIn, 0, 0, 0, reply.data(),
                                               static_cast<std::uint16_t>(reply.size()), kControlTimeoutMs);
  if (received < 0) return usb_error(received, errno, "USB control transfer");
  return static_cast<std::size_t>(received);
}

}  // namespace camloc::kinect
