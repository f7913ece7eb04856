// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The kernel's side of usbfs for the fake Kinect: what ioctls on /dev/bus/usb/BBB/DDD do, and a high-speed bus that carries its
// isochronous packets in microframes of 125 us. Facts: linux/usbdevice_fs.h. Knows nothing of how ioctls get here.
//
// Bus time follows CLOCK_MONOTONIC. In lossless pace it waits for a client that is late with its buffers (at most 100 ms), so that a
// loaded machine loses no packet; the waits are counted as held. In real-time pace such packets are lost, as on a real bus.
#pragma once

#include <sys/types.h>

#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/fakes/kinect_rig.h"

namespace camloc::fakes {

enum class BusPace { kLossless, kRealTime };

struct IoctlResult {
  long value = 0;
  int error = 0;  ///< errno where value is -1
};

/// Called when a session has something to reap, or has no more. Called with the host's lock held.
using ReadySink = std::function<void(bool is_ready)>;

/// Thread-safe.
class UsbfsHost {
 public:
  /// `rig` outlives the host, which is then the only one to use it.
  UsbfsHost(KinectRig* rig, BusPace pace, bool has_kernel_driver);
  ~UsbfsHost();
  UsbfsHost(const UsbfsHost&) = delete;
  UsbfsHost& operator=(const UsbfsHost&) = delete;

  /// Somebody opened the device. `pid` is whose memory the arguments point into; when `connection` hangs up, the file was closed or
  /// its process ended.
  void open_session(const void* key, UsbDeviceId device, pid_t pid, UniqueFd connection, ReadySink ready);
  [[nodiscard]] IoctlResult ioctl(const void* key, unsigned long request, std::uint64_t argument);

  /// Ends what all open files wait for, with ESHUTDOWN; from then on they get ENODEV, and only new ones reach the device.
  void disconnect();
  /// KinectRig::command.
  [[nodiscard]] std::string command(std::string_view line);

 private:
  [[nodiscard]] std::string counts() const;

  struct Urb {
    std::uint64_t address = 0;  ///< in the client
    std::uint64_t buffer = 0;
    std::size_t next_packet = 0;
    std::vector<std::uint32_t> lengths;  ///< of the client's packet buffers
    std::vector<std::uint32_t> actual;
    std::vector<std::int32_t> statuses;
    std::vector<std::uint8_t> data;  ///< what arrived, one packet after the other
    std::int32_t status = 0;
    std::int32_t actual_length = 0;
    std::size_t data_skip = 0;  ///< where `data` goes in the buffer (after a setup packet)
    bool is_iso = false;
  };
  using UrbPtr = std::unique_ptr<Urb>;
  struct Session {
    UsbDeviceId device = UsbDeviceId::kCamera;
    pid_t pid = 0;
    UniqueFd connection;
    ReadySink ready;
    bool is_gone = false;  ///< its device was unplugged
    bool has_claimed = false;
    std::array<std::deque<UrbPtr>, 2> queued;  ///< by stream
    std::deque<UrbPtr> done;
  };
  struct Endpoint {
    std::int64_t next_ns = 0;  ///< of the next microframe
    bool is_listening = false;
    std::int64_t dry_since_ns = 0;  ///< CLOCK_MONOTONIC when the last buffer was used up
  };

  void run();
  void close_dead_sessions();
  void advance();
  void carry(StreamId stream, std::int64_t until_ns);
  [[nodiscard]] std::int64_t held_target(std::int64_t target_ns);
  [[nodiscard]] std::size_t queued_packets(StreamId stream) const;
  [[nodiscard]] Session* listener(StreamId stream);
  [[nodiscard]] std::int64_t next_due_ns() const;
  void complete(Session* session, UrbPtr urb);
  void drop_urbs(Session* session);

  [[nodiscard]] IoctlResult dispatch(Session* session, unsigned long request, std::uint64_t argument);
  [[nodiscard]] IoctlResult submit(Session* session, std::uint64_t argument);
  [[nodiscard]] IoctlResult submit_control(Session* session, UrbPtr urb, std::int32_t buffer_length);
  [[nodiscard]] IoctlResult submit_iso(Session* session, UrbPtr urb, int endpoint, std::int32_t num_packets);
  [[nodiscard]] IoctlResult discard(Session* session, std::uint64_t argument);
  [[nodiscard]] IoctlResult reap(Session* session, std::uint64_t argument);
  [[nodiscard]] IoctlResult claim(Session* session);
  [[nodiscard]] IoctlResult driver_ioctl(Session* session, std::uint64_t argument);
  [[nodiscard]] IoctlResult disconnect_claim(Session* session);
  [[nodiscard]] IoctlResult get_driver(Session* session, std::uint64_t argument);
  [[nodiscard]] bool deliver(const Session& session, const Urb& urb);

  KinectRig* rig_;
  BusPace pace_;
  const bool has_driver_;
  bool is_driver_bound_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool is_stopping_ = false;
  std::map<const void*, Session> sessions_;
  std::array<Endpoint, 2> endpoints_;
  std::int64_t next_check_ns_ = 0;  ///< for dead sessions, CLOCK_MONOTONIC
  std::int64_t origin_ns_;          ///< CLOCK_MONOTONIC of bus time 0
  std::int64_t held_ns_ = 0;
  std::int64_t bus_ns_ = 0;
  IsoPacket packet_;
  std::vector<UrbPtr> spare_;
  std::uint64_t num_submitted_ = 0, num_reaped_ = 0, num_discarded_ = 0, num_ioctls_ = 0, num_detached_ = 0, num_attached_ = 0;
  std::uint64_t num_sessions_ = 0;
  std::thread thread_;
};

}  // namespace camloc::fakes
