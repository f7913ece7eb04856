// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One opened Kinect camera on USB: its control transfers, its two streams, and the thread that handles libusb's events. The
// thread is the device's own, so that no packet is lost while the reader of the frames is busy.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "core/base/result.h"
#include "drivers/kinect/iso_stream.h"
#include "drivers/kinect/kinect_control.h"
#include "drivers/kinect/kinect_receiver.h"
#include "drivers/kinect/kinect_usb.h"

namespace camloc::kinect {

/// For one thread, beside its own event thread. Takes the interface from a kernel driver and gives it back when destroyed.
class KinectDevice final : public ControlTransport {
 public:
  /// `selector`: see open_camera(). `receiver` outlives the device.
  [[nodiscard]] static Result<std::unique_ptr<KinectDevice>> open(const std::string& selector, KinectReceiver* receiver);
  ~KinectDevice() override;

  [[nodiscard]] const OpenCamera& camera() const { return camera_; }
  [[nodiscard]] libusb_context* context() const { return context_.get(); }
  [[nodiscard]] libusb_device* usb_device() const { return libusb_get_device(camera_.handle.get()); }

  /// Transfers only; the registers that make the camera send are KinectControl's.
  [[nodiscard]] Status start_transfers(bool with_depth);
  void stop_transfers();
  /// The first submission that failed since, as text for people; ok() if none did.
  [[nodiscard]] Status transfer_problem() const;
  /// Resets the device on the bus; it has to be opened again.
  [[nodiscard]] Status reset();

  [[nodiscard]] Status send(std::span<const std::uint8_t> request) override;
  [[nodiscard]] Result<std::size_t> receive(std::span<std::uint8_t> reply) override;
  void pause(std::chrono::microseconds duration) override { std::this_thread::sleep_for(duration); }

 private:
  static constexpr unsigned kControlTimeoutMs = 500;

  KinectDevice(UsbContext context, OpenCamera camera, const StreamSetting& setting, KinectReceiver* receiver);
  [[nodiscard]] Status claim();
  void handle_events();

  UsbContext context_;
  OpenCamera camera_;
  StreamSetting setting_;
  IsoStream color_, depth_;
  bool is_claimed_ = false;
  std::atomic<bool> should_stop_{false};
  std::thread event_thread_;
};

}  // namespace camloc::kinect
