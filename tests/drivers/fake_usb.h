// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A folder that looks like /, with what the kernel would say about USB devices in it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "drivers/usb_devices.h"
#include "tests/drivers/test_folder.h"

namespace camloc {

struct FakeUsbDevice {
  std::uint16_t vendor = 0, product = 0;
  int address = 1;
  std::string serial = "", driver = "";
  std::string speed = "480";
};

/// A device of that vendor and product, without anything else.
inline UsbDevice bare_usb_device(std::uint16_t vendor, std::uint16_t product) {
  UsbDevice device;
  device.vendor = vendor;
  device.product = product;
  return device;
}

class FakeUsb {
 public:
  [[nodiscard]] SystemFolders folders() const { return {folder_.path()}; }

  void write(const std::string& path, const std::string& text) const { folder_.write(path.substr(1), text); }
  /// `name` as in /sys/bus/usb/devices: "1-2.3". Makes its node in /dev, too.
  void add(const std::string& name, const FakeUsbDevice& device) const {
    char id[8];
    const std::string folder = "/sys/bus/usb/devices/" + name;
    std::snprintf(id, sizeof id, "%04x", device.vendor);
    write(folder + "/idVendor", id);
    std::snprintf(id, sizeof id, "%04x", device.product);
    write(folder + "/idProduct", id);
    write(folder + "/busnum", name.substr(0, 1) + "\n");
    write(folder + "/devnum", std::to_string(device.address) + "\n");
    write(folder + "/speed", device.speed + "\n");
    if (!device.serial.empty()) write(folder + "/serial", device.serial + "\n");
    const std::string interface = folder + "/" + name + ":1.0";
    std::filesystem::create_directories(folder_.path() + interface);
    if (!device.driver.empty())
      std::filesystem::create_symlink("../../../bus/usb/drivers/" + device.driver, folder_.path() + interface + "/driver");
    std::snprintf(id, sizeof id, "%03d", device.address);
    write("/dev/bus/usb/00" + name.substr(0, 1) + "/" + id, "");
  }

 private:
  TestFolder folder_;
};

}  // namespace camloc
