// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Finding and opening a Kinect on the bus, and libusb's errors in words that help.
#pragma once

#include <libusb.h>

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/result.h"

namespace camloc::kinect {

template <auto kFree>
struct UsbDeleter {
  void operator()(auto* object) const { kFree(object); }
};
using UsbContext = std::unique_ptr<libusb_context, UsbDeleter<libusb_exit>>;
using UsbHandle = std::unique_ptr<libusb_device_handle, UsbDeleter<libusb_close>>;
using UsbTransfer = std::unique_ptr<libusb_transfer, UsbDeleter<libusb_free_transfer>>;

/// libusb's `code` for what failed, in one line: permission names the udev rule, memory and bandwidth what to do. kUnavailable
/// where the device is gone or may come back, kIo for permission, else kIo. `system_error` is errno at the failure, 0 if unknown.
[[nodiscard]] Status usb_error(int code, int system_error, const std::string& what);

/// A camera that was found and opened.
struct OpenCamera {
  UsbHandle handle;
  std::string serial;    ///< its own or, where it has none (model 1473), that of the audio device beside it; may be empty
  std::string location;  ///< "bus 1 port 2.3" or "bus 1 device 4"
  std::uint16_t product = 0, release = 0;
  [[nodiscard]] std::string model() const;
};

/// `selector`: empty for the first camera, a number below 100 for its index in the order of the bus, else a serial number.
/// kUnavailable: there is none, and what there is instead; kIo: no permission.
[[nodiscard]] Result<OpenCamera> open_camera(libusb_context* context, const std::string& selector);

/// The motor in the same housing as `camera`, or nullptr: not all models have one.
[[nodiscard]] UsbHandle open_motor(libusb_context* context, libusb_device* camera);

/// The alternate setting of the camera's interface that has both isochronous endpoints, and their packet sizes.
struct StreamSetting {
  int alternate = 0;
  int color_packet_bytes = 0, depth_packet_bytes = 0;
};
/// kUnsupported: the descriptors have no such setting.
[[nodiscard]] Result<StreamSetting> find_stream_setting(libusb_device* camera);

}  // namespace camloc::kinect
