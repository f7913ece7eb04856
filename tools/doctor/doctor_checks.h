// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What `camloc doctor` looks at, one function a cause. Each is told what it needs (folders, answers of other programs), so that
// every outcome can be tested; none changes anything.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/io/image_file.h"
#include "drivers/sources.h"
#include "tools/common/control_client.h"

namespace camloc::tools {

inline constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

enum class Level { kOk, kWarning, kFailure };

struct Check {
  std::string name;
  Level level = Level::kOk;
  std::string detail;
  std::string advice;  ///< what to do, with the command where there is one; empty when nothing
};

/// What camlocd would run with: its configuration, then the command line of doctor.
struct Settings {
  std::string map_path, source_url, camera_path;
  std::string lcm_url = kDefaultLcmUrl;
  std::string socket_path = kDefaultControlSocket;

  [[nodiscard]] std::string scheme() const;  ///< "kinect" of kinect://; "replay" of a bare path
};

/// The answer of a running camlocd to "status"; it owns the camera then.
using DaemonAnswer = std::optional<nlohmann::ordered_json>;

// doctor_setup.cc: what was configured
[[nodiscard]] Check check_config(const std::string& path, Settings* settings);
[[nodiscard]] Check check_map(const std::string& path);
/// Opens the source and waits for a frame, unless a daemon has it. `size`: of the frame's image, where there was one.
[[nodiscard]] Check check_source(const std::string& url, const DaemonAnswer& daemon, std::optional<ImageSize>* size);
[[nodiscard]] Check check_calibration(const std::string& path, const DaemonAnswer& daemon, const std::optional<ImageSize>& size);

// doctor_usb.cc: what is plugged in; `scheme` is that of the source
/// Whether a kind of camera is there; `is_wanted`: it is the source.
[[nodiscard]] Check check_presence(const SourceEntry& source, const CameraListing& listing, bool is_wanted);
/// Whether camlocd may open the cameras: `service_group` is the group of the devices that it is in (plugdev).
[[nodiscard]] Check check_usb_rights(const std::vector<UsbDevice>& devices, const SystemFolders& folders, gid_t service_group);
[[nodiscard]] Check check_usb_driver(const std::vector<UsbDevice>& devices, const std::string& scheme, bool is_daemon_running);
[[nodiscard]] Check check_usb_bandwidth(const std::vector<UsbDevice>& devices, const SystemFolders& folders);

// doctor_system.cc: what it runs on
[[nodiscard]] Check check_daemon(const std::string& socket_path, DaemonAnswer* daemon);
/// `properties`: of `systemctl show camlocd`, lines KEY=VALUE.
[[nodiscard]] Check check_service(const std::string& properties);
[[nodiscard]] Check check_lcm(const std::string& url);
struct ClockState {
  std::int64_t epoch_s = 0;
  bool is_synchronized = false;
};
[[nodiscard]] ClockState read_clock();
[[nodiscard]] Check check_clock(const ClockState& clock);
[[nodiscard]] Check check_cpu();
[[nodiscard]] Check check_memory(const SystemFolders& folders);

// multicast_route.cc: LCM needs a route to its multicast group, even between programs of one machine; asking first gives a better answer
// than LCM's own failure
struct MulticastRoute {
  std::string group;          ///< address the URL names, empty for URLs without a network (file://, memq://)
  std::string local_address;  ///< of the interface packets leave by; 127.* stays on this machine
  int ttl = 0;
};

/// kInvalid: not an LCM URL; kUnavailable: no route, with the commands that add one.
[[nodiscard]] Result<MulticastRoute> find_multicast_route(const std::string& lcm_url);

}  // namespace camloc::tools
