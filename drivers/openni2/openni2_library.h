// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// OpenNI2's C API, loaded when a camera asks for it: linking it would cost every start of the daemon time and memory, and its
// package is only recommended. Only its headers are needed to build.
#pragma once

#include <OniCAPI.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace camloc::openni2 {

/// The functions in use, by their names in OniCAPI.h.
struct Api {
  decltype(&::oniInitialize) initialize = nullptr;
  decltype(&::oniShutdown) shutdown = nullptr;
  decltype(&::oniGetVersion) get_version = nullptr;
  decltype(&::oniGetExtendedError) get_extended_error = nullptr;
  decltype(&::oniSetLogConsoleOutput) set_log_console_output = nullptr;
  decltype(&::oniSetLogFileOutput) set_log_file_output = nullptr;
  decltype(&::oniGetDeviceList) get_device_list = nullptr;
  decltype(&::oniReleaseDeviceList) release_device_list = nullptr;
  decltype(&::oniRegisterDeviceCallbacks) register_device_callbacks = nullptr;
  decltype(&::oniUnregisterDeviceCallbacks) unregister_device_callbacks = nullptr;
  decltype(&::oniWaitForAnyStream) wait_for_any_stream = nullptr;
  decltype(&::oniDeviceOpen) device_open = nullptr;
  decltype(&::oniDeviceClose) device_close = nullptr;
  decltype(&::oniDeviceGetSensorInfo) device_get_sensor_info = nullptr;
  decltype(&::oniDeviceGetInfo) device_get_info = nullptr;
  decltype(&::oniDeviceCreateStream) device_create_stream = nullptr;
  decltype(&::oniDeviceEnableDepthColorSync) device_enable_depth_color_sync = nullptr;
  decltype(&::oniDeviceDisableDepthColorSync) device_disable_depth_color_sync = nullptr;
  decltype(&::oniDeviceGetDepthColorSyncEnabled) device_get_depth_color_sync_enabled = nullptr;
  decltype(&::oniDeviceGetProperty) device_get_property = nullptr;
  decltype(&::oniDeviceSetProperty) device_set_property = nullptr;
  decltype(&::oniDeviceIsImageRegistrationModeSupported) device_is_image_registration_mode_supported = nullptr;
  decltype(&::oniStreamDestroy) stream_destroy = nullptr;
  decltype(&::oniStreamStart) stream_start = nullptr;
  decltype(&::oniStreamStop) stream_stop = nullptr;
  decltype(&::oniStreamReadFrame) stream_read_frame = nullptr;
  decltype(&::oniStreamGetProperty) stream_get_property = nullptr;
  decltype(&::oniStreamSetProperty) stream_set_property = nullptr;
  decltype(&::oniFrameRelease) frame_release = nullptr;
};

/// A device as the library lists it.
struct DeviceEntry {
  std::string uri;
  std::string vendor;
  std::string name;
  int usb_vendor_id = 0;
  int usb_product_id = 0;
};

/// Where the code of the library is.
struct LoadedLibrary {
  Api api;
  std::string path;  ///< as the loader found it
  OniVersion version{};
};

/// Loads libOpenNI2.so.0 once and for good (it starts threads; unloading it is not safe). kUnavailable: not installed, with
/// the package's name; kUnsupported: another version of its interface.
[[nodiscard]] Result<const LoadedLibrary*> load_library();

/// Set when the device goes away. Shared by a source and the library's thread.
using GoneFlag = std::shared_ptr<std::atomic<bool>>;

/// The initialized library; lives as long as somebody holds it, so that it is shut down after the last camera and looks for
/// devices anew before the next. Thread-safe.
class Session {
 public:
  /// The one session of the process, initialized if there is none. kUnavailable where that fails: the drivers' folder is
  /// the usual reason, see installation.h.
  [[nodiscard]] static Result<std::shared_ptr<Session>> acquire();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const LoadedLibrary& library() const { return library_; }
  [[nodiscard]] const Api& api() const { return library_.api; }
  [[nodiscard]] std::vector<DeviceEntry> devices() const;
  /// The library's words for its last error, in one line.
  [[nodiscard]] std::string last_error() const;

  /// `gone` becomes true when the device disconnects or reports an error.
  void watch(const std::string& uri, GoneFlag gone);
  void unwatch(const GoneFlag& gone);

 private:
  explicit Session(const LoadedLibrary& library) : library_(library) {}
  void mark_gone(const char* uri);
  static void on_disconnected(const OniDeviceInfo* info, void* cookie);
  static void on_state(const OniDeviceInfo* info, OniDeviceState state, void* cookie);

  struct Watch {
    std::string uri;
    GoneFlag gone;
  };
  const LoadedLibrary& library_;
  OniCallbackHandle callbacks_ = nullptr;
  std::mutex mutex_;
  std::vector<Watch> watches_;
};

}  // namespace camloc::openni2
