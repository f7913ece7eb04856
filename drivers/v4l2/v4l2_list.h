// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which cameras the kernel has, by what it says in /sys, and who they are: serial, stable name, USB address.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "drivers/frame_source.h"
#include "drivers/usb_devices.h"
#include "drivers/v4l2/v4l2_device.h"
#include "drivers/v4l2/v4l2_pixel_format.h"

namespace camloc {

struct V4l2DeviceInfo {
  std::string path;      ///< /dev/videoN
  std::string name;      ///< for people, as the driver gives it
  std::string bus;       ///< e.g. usb-0000:00:14.0-1
  std::string serial;    ///< of the USB device; empty where it has none
  std::string usb_node;  ///< /dev/bus/usb/BBB/DDD; empty for a device that is not on USB
  std::vector<V4l2FormatOffer> formats;
  std::string problem;  ///< why the node could not be opened, in one line; empty where it could
};

/// Every node that gives images, in the order of their numbers, and those that could not be asked (with `problem`). Nodes for
/// metadata or output are left out. A camera in use is listed, too.
[[nodiscard]] std::vector<V4l2DeviceInfo> list_v4l2_devices(V4l2Io& io, const SystemFolders& folders);

/// The same for people. A device with a serial is named by it, whichever node it gets.
[[nodiscard]] CameraListing list_v4l2_cameras(V4l2Io& io, const SystemFolders& folders);
[[nodiscard]] CameraListing list_v4l2_cameras(const SystemFolders& folders);

/// What /sys says about the node `path`, which may be a link: `path` as /dev/videoN, serial, usb_node.
[[nodiscard]] V4l2DeviceInfo describe_v4l2_node(const std::string& path, const SystemFolders& folders);

/// The node of the device with this serial that fits the role best: for images one with colour before infrared, for depth one
/// with Z16 or 11-bit disparity before one whose 16-bit words may be infrared. kUnavailable lists the serials there are.
[[nodiscard]] Result<std::string> find_v4l2_node(V4l2Io& io, const SystemFolders& folders, const std::string& serial, V4l2Role role);

}  // namespace camloc
