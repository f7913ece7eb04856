// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth cameras on USB: there, allowed, free, and with bandwidth enough.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "tools/common/text_format.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

constexpr double kHighSpeed_mbps = 480;
constexpr int kMinUsbfsMb = 16;  // the kernel's default; both streams of a Kinect take 3 MB of it
constexpr const char* kRules = "/lib/udev/rules.d/60-camloc.rules";

bool has_driver(const UsbDevice& device, const std::string& driver) {
  return std::find(device.drivers.begin(), device.drivers.end(), driver) != device.drivers.end();
}

std::string called(const UsbDevice& device) { return device.usb_id() + " at USB " + device.name; }

/// Whether a program that is in `group` and is not the owner may read and write.
bool may_open(const struct stat& node, gid_t group) {
  if ((node.st_mode & (S_IROTH | S_IWOTH)) == (S_IROTH | S_IWOTH)) return true;
  return node.st_gid == group && (node.st_mode & (S_IRGRP | S_IWGRP)) == (S_IRGRP | S_IWGRP);
}

bool has_rules(const SystemFolders& folders) {
  std::error_code error;
  return std::filesystem::exists(folders.path(kRules), error) || std::filesystem::exists(folders.path(std::string("/usr") + kRules), error);
}

}  // namespace

Check check_presence(const SourceEntry& source, const CameraListing& listing, bool is_wanted) {
  const Level bad = is_wanted ? Level::kFailure : Level::kWarning;
  if (!listing.problem.empty()) return {source.scheme, bad, listing.problem, listing.advice};
  if (listing.cameras.empty())
    return {source.scheme, bad, "no " + std::string(source.scheme) + ":// camera is there; looked at: " + listing.searched, listing.advice};
  std::string found;
  for (const FoundCamera& camera : listing.cameras) {
    if (!camera.problem.empty()) return {source.scheme, bad, camera.url + ": " + camera.problem, listing.advice};
    found += (found.empty() ? "" : ", ") + camera.url + " (" + camera.where + ")";
  }
  return {source.scheme, Level::kOk, found, ""};
}

Check check_usb_rights(const std::vector<UsbDevice>& devices, const SystemFolders& folders, gid_t service_group) {
  std::string fine;
  for (const UsbDevice& device : devices) {
    if (!is_usb_camera(device)) continue;
    struct stat node {};
    if (::stat(folders.path(device.node()).c_str(), &node) != 0)
      return {"usb rights", Level::kFailure, device.node() + " does not exist", "sudo udevadm trigger --subsystem-match=usb"};
    if (!may_open(node, service_group)) {
      return {"usb rights", Level::kFailure,
              device.node() + text_of(" (%s) has mode %04o and not the group plugdev with 0660: camlocd may not open it",
                                      called(device).c_str(), node.st_mode & 07777U),
              has_rules(folders) ? "sudo udevadm control --reload; sudo udevadm trigger --subsystem-match=usb --action=add"
                                 : "install the package camloc: it brings 60-camloc.rules"};
    }
    fine += (fine.empty() ? "" : ", ") + device.node();
  }
  return {"usb rights", Level::kOk, fine.empty() ? "no camera to open" : fine + " may be opened", ""};
}

Check check_usb_driver(const std::vector<UsbDevice>& devices, const std::string& scheme, bool is_daemon_running) {
  const Result<const SourceEntry*> wanted = find_source(scheme + "://");
  const bool wants_kernel_node = wanted && (*wanted)->access.kernel_nodes[0] != '\0';
  for (const UsbDevice& device : devices) {
    if (!is_usb_camera(device)) continue;
    if (has_driver(device, "usbfs") && !is_daemon_running) {
      return {"usb driver", Level::kFailure, called(device) + " is in use by another program",
              "'sudo fuser -v " + device.node() + "' names it; end it"};
    }
    const SourceEntry& source = *find_usb_source(device);
    const std::string competitor = source.access.competing_driver;
    if (has_driver(device, competitor) && !wants_kernel_node) {
      return {"usb driver", Level::kWarning,
              called(device) + ": the kernel's " + competitor + " has it; " + source.scheme +
                  ":// takes it away while it runs, other programs do not",
              "echo 'blacklist " + competitor + "' | sudo tee /etc/modprobe.d/camloc.conf; sudo modprobe -r " + competitor};
    }
  }
  return {"usb driver", Level::kOk, is_daemon_running ? "nothing in camlocd's way" : "nothing in the way", ""};
}

Check check_usb_bandwidth(const std::vector<UsbDevice>& devices, const SystemFolders& folders) {
  std::map<int, int> cameras_on_bus;
  bool has_camera = false;
  for (const UsbDevice& device : devices) {
    if (is_usb_camera(device) || has_driver(device, "uvcvideo")) ++cameras_on_bus[device.bus];
    if (!is_usb_camera(device)) continue;
    has_camera = true;
    if (device.speed_mbps < kHighSpeed_mbps) {
      return {"usb bandwidth", Level::kFailure,
              called(device) + text_of(" runs at %g Mbit/s, depth needs %g", device.speed_mbps, kHighSpeed_mbps),
              "plug it into a USB 2 port without an old hub or long cable between; 'lsusb -t' shows the speeds"};
    }
  }
  for (const auto& [bus, count] : cameras_on_bus) {
    if (has_camera && count > 1) {
      return {"usb bandwidth", Level::kWarning, text_of("%d cameras share USB bus %d; two Kinects do not fit", count, bus),
              "plug them into different controllers; 'lsusb -t' shows which port belongs to which"};
    }
  }
  int usbfs_mb = 0;
  std::ifstream(folders.path("/sys/module/usbcore/parameters/usbfs_memory_mb")) >> usbfs_mb;
  if (usbfs_mb > 0 && usbfs_mb < kMinUsbfsMb) {
    return {"usb bandwidth", Level::kWarning, text_of("programs may have %d MB of USB transfers in flight", usbfs_mb),
            text_of("echo %d | sudo tee /sys/module/usbcore/parameters/usbfs_memory_mb", kMinUsbfsMb)};
  }
  return {"usb bandwidth", Level::kOk, has_camera ? "high speed, a bus of its own" : "no camera", ""};
}

}  // namespace camloc::tools
