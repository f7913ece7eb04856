// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The fake Kinect in a umockdev test bed: sysfs entries, device files, uevents, and the way from a client's ioctl to UsbfsHost. The
// topology is that of a real one: camera and motor behind the Kinect's own hub.
//     usb1 (root hub) - 1-1 (hub, 0409:005a) - 1-1.1 motor, 1-1.3 camera
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "tests/fakes/usbfs_host.h"

namespace camloc::fakes {

/// Methods from any one thread at a time; handlers of ioctls run in umockdev's own thread.
class UmockdevBus {
 public:
  /// The process must run under umockdev-wrapper. `host` outlives the bus.
  [[nodiscard]] static Result<std::unique_ptr<UmockdevBus>> create(KinectRig* rig, UsbfsHost* host, bool has_motor);
  ~UmockdevBus();
  UmockdevBus(const UmockdevBus&) = delete;
  UmockdevBus& operator=(const UmockdevBus&) = delete;

  /// Takes the Kinect off the bus as the kernel does: URBs end, uevents "remove", no more entries in sysfs and /dev.
  [[nodiscard]] Status unplug();
  /// Plugs it in; device numbers go up, as on a real bus.
  [[nodiscard]] Status replug();

 private:
  struct Impl;
  explicit UmockdevBus(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc::fakes
