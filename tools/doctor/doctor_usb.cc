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

bool is_camera(const UsbDevice& device) { return role_of(device) == UsbRole::kKinectCamera || role_of(device) == UsbRole::kOpenni2Camera; }

bool has_driver(const UsbDevice& device, const char* driver) {
  return std::find(device.drivers.begin(), device.drivers.end(), driver) != device.drivers.end();
}

std::string called(const UsbDevice& device) { return device.usb_id() + " at USB " + device.name; }

std::size_t count_role(const std::vector<UsbDevice>& devices, UsbRole role) {
  return static_cast<std::size_t>(
      std::count_if(devices.begin(), devices.end(), [role](const UsbDevice& device) { return role_of(device) == role; }));
}

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

Check check_usb_presence(const std::vector<UsbDevice>& devices, const std::string& scheme) {
  std::string found;
  for (const UsbDevice& device : devices) {
    if (is_camera(device)) found += (found.empty() ? "" : ", ") + called(device);
  }
  const bool has_kinect = count_role(devices, UsbRole::kKinectCamera) > 0;
  const bool has_rest_of_kinect = count_role(devices, UsbRole::kKinectMotor) + count_role(devices, UsbRole::kKinectAudio) > 0;
  const Level missing = scheme == "kinect" ? Level::kFailure : Level::kWarning;
  if (!has_kinect && has_rest_of_kinect) {
    return {"usb", missing, "the motor or microphone of a Kinect is there, its camera is not",
            "plug in the Kinect's 12 V power supply, then 'camloc camera list'"};
  }
  if (!has_kinect && scheme == "kinect")
    return {"usb", missing, "no Kinect on " + std::to_string(devices.size()) + " USB devices",
            "plug it in and give it power, then 'lsusb -d 045e:'"};
  return {"usb", Level::kOk, found, ""};
}

Check check_usb_rights(const std::vector<UsbDevice>& devices, const SystemFolders& folders, gid_t service_group) {
  std::string fine;
  for (const UsbDevice& device : devices) {
    if (!is_camera(device)) continue;
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
  for (const UsbDevice& device : devices) {
    if (!is_camera(device)) continue;
    if (has_driver(device, "usbfs") && !is_daemon_running) {
      return {"usb driver", Level::kFailure, called(device) + " is in use by another program",
              "'sudo fuser -v " + device.node() + "' names it; end it"};
    }
    if (has_driver(device, "gspca_kinect") && scheme != "v4l2") {
      return {"usb driver", Level::kWarning,
              called(device) + ": the kernel's gspca_kinect has it; kinect:// takes it away while it runs, other programs do not",
              "echo 'blacklist gspca_kinect' | sudo tee /etc/modprobe.d/camloc.conf; sudo modprobe -r gspca_kinect"};
    }
  }
  return {"usb driver", Level::kOk, is_daemon_running ? "nothing in camlocd's way" : "nothing in the way", ""};
}

Check check_usb_bandwidth(const std::vector<UsbDevice>& devices, const SystemFolders& folders) {
  std::map<int, int> cameras_on_bus;
  bool has_camera = false;
  for (const UsbDevice& device : devices) {
    if (is_camera(device) || has_driver(device, "uvcvideo")) ++cameras_on_bus[device.bus];
    if (!is_camera(device)) continue;
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

Check check_openni2(const Openni2Installation& openni2, const std::string& scheme) {
  const Level bad = scheme == "openni2" ? Level::kFailure : Level::kWarning;
  if (!openni2.is_library_found) return {"openni2", bad, openni2.problem, "sudo apt install libopenni2-0"};
  const auto is_loaded = [](const Openni2Driver& driver) { return driver.is_loaded; };
  const auto num_loaded = std::count_if(openni2.drivers.begin(), openni2.drivers.end(), is_loaded);
  if (!openni2.is_started || num_loaded == 0) {
    return {"openni2", bad, openni2.problem.empty() ? "no driver in " + openni2.drivers_folder + " was loaded" : openni2.problem,
            "ls " + openni2.drivers_folder + "; drivers are called lib*.so.0; Repository= in /etc/openni2/OpenNI.ini names another folder"};
  }
  if (openni2.devices.empty()) {
    return {"openni2", bad,
            text_of("%d drivers in %s, none of them has a device", static_cast<int>(num_loaded), openni2.drivers_folder.c_str()),
            "plug the camera in and see 'usb rights'; a Kinect V1 is kinect://, not openni2://"};
  }
  return {"openni2", Level::kOk,
          text_of("%s, %d drivers, %s", openni2.version.c_str(), static_cast<int>(num_loaded), openni2.devices.front().uri.c_str()), ""};
}

}  // namespace camloc::tools
