// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One opened Kinect camera on USB: its control transfers, its two streams, and the thread that handles libusb's events. The
// thread is the device's own, so that no packet is lost while the reader of the frames is busy.
#pragma once

#include <libusb.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/result.h"
#include "drivers/kinect/kinect_control.h"
#include "drivers/kinect/kinect_receiver.h"
#include "drivers/kinect/kinect_usb.h"

namespace camloc::kinect {

/// Isochronous transfers of one endpoint, kept in flight until they are stopped.
/// libusb's event handling runs in a thread of its own; all else is for the owner's thread. Buffers are allocated by start();
/// libusb itself allocates a request block with every submission.
class IsoStream {
 public:
  IsoStream(Stream stream, KinectReceiver* receiver) : stream_(stream), receiver_(receiver) {}
  ~IsoStream();
  IsoStream(const IsoStream&) = delete;
  IsoStream& operator=(const IsoStream&) = delete;

  /// 40 ms in flight. Long transfers wake the host half as often; their buffers of 61 KB are more than a kernel whose memory is
  /// fragmented may find, then they are halved.
  static constexpr int kPacketsInFlight = 320;
  static constexpr int kLongTransfer = 32, kShortTransfer = 16;  ///< packets
  static constexpr std::chrono::milliseconds kDrainPatience{1000};
  static constexpr std::int64_t kPacketIntervalNs = 125'000;  ///< a micro-frame of USB 2.0

  [[nodiscard]] Status start(libusb_device_handle* handle, std::uint8_t endpoint, int packet_bytes);
  /// Cancels all and waits for libusb to give them back. false: it did not within `patience`; buffers are then never freed.
  [[nodiscard]] bool stop(std::chrono::milliseconds patience);
  /// libusb's code of the first submission that failed while streaming, or 0.
  [[nodiscard]] int submit_error() const { return submit_error_.load(std::memory_order_relaxed); }
  [[nodiscard]] int submit_errno() const { return submit_errno_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    UsbTransfer transfer;
    std::vector<std::uint8_t> buffer;
  };
  void handle(libusb_transfer* transfer);
  void receive(libusb_transfer* transfer);
  [[nodiscard]] bool submit(libusb_transfer* transfer);
  [[nodiscard]] bool lacks_memory() const;
  void allocate(int packets_per_transfer, int packet_bytes);
  [[nodiscard]] Status submit_all(libusb_device_handle* handle, std::uint8_t endpoint, int packet_bytes);

  Stream stream_;
  KinectReceiver* receiver_;
  std::vector<Slot> slots_;
  int packets_per_transfer_ = kLongTransfer;
  std::atomic<bool> is_stopping_{false};
  std::atomic<int> num_in_flight_{0}, submit_error_{0}, submit_errno_{0};
};

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
