// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The files are those of the Linux kernel's Documentation/ABI/stable/sysfs-bus-usb.
#include "drivers/usb_devices.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <tuple>

#include "core/io/text.h"

namespace camloc {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxDevices = 1000;

std::optional<std::uint16_t> read_hex(const fs::path& path) {
  const std::string text = read_system_attribute(path);
  std::uint16_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? std::optional(value) : std::nullopt;
}

std::vector<std::string> drivers_of(const fs::path& folder, const std::string& name) {
  std::vector<std::string> drivers;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!entry.path().filename().string().starts_with(name + ":")) continue;  // an interface: "1-2:1.0"
    const fs::path driver = fs::read_symlink(entry.path() / "driver", error);
    if (!error) drivers.push_back(driver.filename().string());
  }
  std::sort(drivers.begin(), drivers.end());
  drivers.erase(std::unique(drivers.begin(), drivers.end()), drivers.end());
  return drivers;
}

}  // namespace

std::string read_system_attribute(const fs::path& path) {
  std::ifstream file(path);
  char text[256] = {};
  file.read(text, sizeof(text) - 1);
  const std::string_view line = std::string_view(text).substr(0, std::string_view(text).find('\n'));
  std::string result(trimmed(line));
  std::replace_if(
      result.begin(), result.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return result;
}

std::optional<UsbDevice> read_usb_device(const fs::path& folder) {
  const auto vendor = read_hex(folder / "idVendor"), product = read_hex(folder / "idProduct");
  const auto bus = parse_int(read_system_attribute(folder / "busnum")), address = parse_int(read_system_attribute(folder / "devnum"));
  if (!vendor || !product || !bus || !address || *bus < 1 || *bus > 999 || *address < 1 || *address > 127) return std::nullopt;
  UsbDevice device;
  device.name = folder.filename().string();
  device.vendor = *vendor;
  device.product = *product;
  device.bus = static_cast<int>(*bus);
  device.address = static_cast<int>(*address);
  device.serial = read_system_attribute(folder / "serial");
  device.speed_mbps = parse_double(read_system_attribute(folder / "speed")).value_or(0);
  device.drivers = drivers_of(folder, device.name);
  return device;
}

std::string UsbDevice::node() const {
  char text[48];
  std::snprintf(text, sizeof(text), "/dev/bus/usb/%03d/%03d", bus, address);
  return text;
}

std::string UsbDevice::usb_id() const {
  char text[16];
  std::snprintf(text, sizeof(text), "%04x:%04x", unsigned{vendor}, unsigned{product});
  return text;
}

std::string UsbDevice::hub() const {
  const std::size_t last = name.find_last_of(".-");
  return last == std::string::npos ? "" : name.substr(0, last);
}

std::vector<UsbDevice> list_usb_devices(const SystemFolders& folders) {
  std::vector<UsbDevice> devices;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folders.path("/sys/bus/usb/devices"), error)) {
    if (devices.size() == kMaxDevices) break;
    if (auto device = read_usb_device(entry.path())) devices.push_back(std::move(*device));
  }
  std::sort(devices.begin(), devices.end(),
            [](const UsbDevice& a, const UsbDevice& b) { return std::tie(a.bus, a.address) < std::tie(b.bus, b.address); });
  return devices;
}

}  // namespace camloc
