// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is on USB, by what the kernel says in /sys: nothing is opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace camloc {

/// Where the trees of the kernel and of udev are; tests have their own.
struct SystemFolders {
  std::string root;  ///< put before every absolute path; empty for this machine

  [[nodiscard]] std::string path(const std::string& absolute) const { return root + absolute; }
};

/// The first line of a small file of the kernel, without blanks around it; what cannot be printed becomes '?'. Empty without a file.
[[nodiscard]] std::string read_system_attribute(const std::filesystem::path& path);

struct UsbDevice {
  std::string name;  ///< "1-2.3": bus and ports
  std::uint16_t vendor = 0, product = 0;
  std::string serial;  ///< empty where it has none
  int bus = 0, address = 0;
  double speed_mbps = 0;             ///< 480 for high speed
  std::vector<std::string> drivers;  ///< of its interfaces: "gspca_kinect", "usbfs" for a program

  [[nodiscard]] std::string node() const;    ///< "/dev/bus/usb/001/004"
  [[nodiscard]] std::string usb_id() const;  ///< "045e:02ae"
  [[nodiscard]] std::string hub() const;     ///< name of what it is plugged into
};

/// Devices that a source opens over USB, as in 60-camloc.rules.
struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;  ///< 0: all of the vendor's
  bool is_camera = true;      ///< false: a part beside the camera, which gives no images

  [[nodiscard]] bool matches(const UsbDevice& device) const {
    return device.vendor == vendor && (product == 0 || device.product == product);
  }
};

/// Some devices of a kind all say 0000000000000000.
[[nodiscard]] inline bool is_placeholder_serial(const std::string& serial) { return serial.find_first_not_of('0') == std::string::npos; }

/// From its folder below /sys/devices; nullopt where that is none of a USB device.
[[nodiscard]] std::optional<UsbDevice> read_usb_device(const std::filesystem::path& folder);

/// In the order of bus and address; hubs are among them. Empty where there is no USB.
[[nodiscard]] std::vector<UsbDevice> list_usb_devices(const SystemFolders& folders = {});

}  // namespace camloc
