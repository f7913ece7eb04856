// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is on USB, by what the kernel says in /sys: nothing is opened. For `camloc camera list` and `camloc doctor`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace camloc::tools {

/// Where the trees of the kernel and of udev are; tests have their own.
struct SystemFolders {
  std::string root;  ///< put before every absolute path; empty for this machine

  [[nodiscard]] std::string path(const std::string& absolute) const { return root + absolute; }
};

struct UsbDevice {
  std::string name;  ///< "1-2.3": bus and ports
  std::uint16_t vendor = 0, product = 0;
  std::string serial, product_name;  ///< empty where it has none
  int bus = 0, address = 0;
  double speed_mbps = 0;             ///< 480 for high speed
  std::vector<std::string> drivers;  ///< of its interfaces: "gspca_kinect", "usbfs" for a program

  [[nodiscard]] std::string node() const;    ///< "/dev/bus/usb/001/004"
  [[nodiscard]] std::string usb_id() const;  ///< "045e:02ae"
  [[nodiscard]] std::string hub() const;     ///< name of what it is plugged into
};

enum class UsbRole { kNone, kKinectCamera, kKinectMotor, kKinectAudio, kOpenni2Camera };
/// By vendor and product alone, as in 60-camloc.rules.
[[nodiscard]] UsbRole role_of(const UsbDevice& device);

/// In the order of bus and address; hubs are among them. Empty where there is no USB.
[[nodiscard]] std::vector<UsbDevice> list_usb_devices(const SystemFolders& folders = {});

/// The device's own serial number or, of a Kinect model 1473, that of the audio device in the same housing.
[[nodiscard]] std::string kinect_serial(const UsbDevice& camera, const std::vector<UsbDevice>& devices);

}  // namespace camloc::tools
