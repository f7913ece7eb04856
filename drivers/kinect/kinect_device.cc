// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See kinect_device.h.
#include "drivers/kinect/kinect_device.h"

#include <cerrno>
#include <utility>

namespace camloc::kinect {

KinectDevice::KinectDevice(UsbContext context, OpenCamera camera, const StreamSetting& setting, KinectReceiver* receiver)
    : context_(std::move(context)),
      camera_(std::move(camera)),
      setting_(setting),
      color_(Stream::kColor, receiver),
      depth_(Stream::kDepth, receiver) {}

Result<std::unique_ptr<KinectDevice>> KinectDevice::open(const std::string& selector, KinectReceiver* receiver) {
  Result<UsbContext> context = create_usb_context();
  if (!context) return context.status();
  Result<OpenCamera> camera = open_camera(context->get(), selector);
  if (!camera) return camera.status();
  const Result<StreamSetting> setting = find_stream_setting(libusb_get_device(camera->handle.get()));
  if (!setting) return setting.status();
  std::unique_ptr<KinectDevice> device(new KinectDevice(std::move(context).value(), std::move(camera).value(), *setting, receiver));
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
