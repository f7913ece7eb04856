// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Isochronous transfers of one endpoint, kept in flight until they are stopped.
#pragma once

#include <libusb.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/result.h"
#include "drivers/kinect/kinect_receiver.h"

namespace camloc::kinect {

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
  struct TransferDeleter {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  struct Slot {
    std::unique_ptr<libusb_transfer, TransferDeleter> transfer;
    std::vector<std::uint8_t> buffer;
  };
  static void LIBUSB_CALL on_transfer(libusb_transfer* transfer);
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

}  // namespace camloc::kinect
