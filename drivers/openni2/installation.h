// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What there is of OpenNI2 on this machine, and which cameras its drivers find. "No device" most often means that the library does not find
// its drivers: it looks for them in OpenNI2/Drivers beside its own file (or where OpenNI.ini says), and Debian's build takes
// only files that are called lib*.so.0.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/frame_source.h"
#include "drivers/usb_devices.h"

namespace camloc {

struct Openni2Installation {
  bool is_library_found = false;  ///< and of a version that can be used
  bool is_started = false;        ///< the library accepted to work
  std::string problem;            ///< one line, empty where there is none; names the package or the folder to mend
  std::string version;
  std::string drivers_folder;
  std::ptrdiff_t num_drivers = 0;  ///< that the library has loaded from there
  std::vector<FoundCamera> cameras;
};

/// Loads and starts the library and asks it for devices; opens none of them. Takes some 20 ms, longer while a driver waits for
/// its devices.
[[nodiscard]] Openni2Installation inspect_openni2();

/// PrimeSense with its licensees (Asus Xtion), and Orbbec: these vendors make depth cameras only.
inline constexpr UsbId kOpenni2UsbIds[] = {{0x1d27}, {0x2bc5}};

[[nodiscard]] CameraListing listing_of(const Openni2Installation& openni2);
/// listing_of(inspect_openni2()): the library knows no other folders than this machine's.
[[nodiscard]] CameraListing list_openni2_cameras(const SystemFolders& folders);

}  // namespace camloc
