// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One device of the fake Kinect at the host end of a usb-redir connection (the protocol of usbredirparser.h, "usb-redir-protocol.txt"):
// QEMU's `-device usb-redir` is the other end and shows the device to its guest. Isochronous packets leave in real time; what the
// connection does not take is lost, as on a bus.
#pragma once

#include <usbredirparser.h>

#include <array>
#include <cstdint>
#include <memory>

#include "core/base/unique_fd.h"
#include "tests/fakes/kinect_rig.h"

namespace camloc::fakes {

/// Not thread-safe.
class UsbredirDevice {
 public:
  /// Greets the peer at the connected, non-blocking socket. `rig` outlives the device.
  UsbredirDevice(KinectRig* rig, UsbDeviceId id, UniqueFd socket, bool is_plugged);
  ~UsbredirDevice();
  UsbredirDevice(const UsbredirDevice&) = delete;
  UsbredirDevice& operator=(const UsbredirDevice&) = delete;

  [[nodiscard]] int fd() const { return socket_.get(); }
  [[nodiscard]] bool has_output() const;
  /// Reads what has come and answers; false: the peer is gone or talks nonsense.
  [[nodiscard]] bool read(std::int64_t now_ns);
  [[nodiscard]] bool write();
  /// Carries the bus on until `now_ns`.
  void advance(std::int64_t now_ns);
  [[nodiscard]] bool is_streaming() const { return is_iso_on_[0] || is_iso_on_[1]; }
  void plug(bool is_plugged, std::int64_t now_ns);

  /// Packets that the connection did not take.
  [[nodiscard]] std::uint64_t num_overflowed() const { return num_overflowed_; }

 private:
  static UsbredirDevice& of(void* self) { return *static_cast<UsbredirDevice*>(self); }
  void install_callbacks();
  void on_hello();
  void on_control(std::uint64_t id, usb_redir_control_packet_header* header, std::uint8_t* data, int size);
  void on_iso(std::uint64_t id, std::uint8_t endpoint, bool is_on);
  void send_connect();
  void send_endpoints();
  void send_packet(StreamId stream, const IsoPacket& packet, bool is_error);

  KinectRig* rig_;
  UsbDeviceId id_;
  UniqueFd socket_;
  bool is_plugged_;
  bool is_greeted_ = false;
  usbredirparser* parser_;
  std::array<bool, 2> is_iso_on_{};
  std::array<std::uint32_t, 2> next_id_{};
  std::int64_t bus_ns_ = 0;  ///< of the next microframe
  std::int64_t now_ns_ = 0;
  std::uint64_t num_overflowed_ = 0;
  IsoPacket packet_;
};

}  // namespace camloc::fakes
