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

/// FUNCTION(name here, name in OniCAPI.h) for all in use.
#define CAMLOC_OPENNI2_FUNCTIONS(FUNCTION)                                                         \
  FUNCTION(initialize, oniInitialize)                                                              \
  FUNCTION(shutdown, oniShutdown)                                                                  \
  FUNCTION(get_version, oniGetVersion)                                                             \
  FUNCTION(get_extended_error, oniGetExtendedError)                                                \
  FUNCTION(set_log_console_output, oniSetLogConsoleOutput)                                         \
  FUNCTION(set_log_file_output, oniSetLogFileOutput)                                               \
  FUNCTION(get_device_list, oniGetDeviceList)                                                      \
  FUNCTION(release_device_list, oniReleaseDeviceList)                                              \
  FUNCTION(register_device_callbacks, oniRegisterDeviceCallbacks)                                  \
  FUNCTION(unregister_device_callbacks, oniUnregisterDeviceCallbacks)                              \
  FUNCTION(wait_for_any_stream, oniWaitForAnyStream)                                               \
  FUNCTION(device_open, oniDeviceOpen)                                                             \
  FUNCTION(device_close, oniDeviceClose)                                                           \
  FUNCTION(device_get_sensor_info, oniDeviceGetSensorInfo)                                         \
  FUNCTION(device_create_stream, oniDeviceCreateStream)                                            \
  FUNCTION(device_enable_depth_color_sync, oniDeviceEnableDepthColorSync)                          \
  FUNCTION(device_disable_depth_color_sync, oniDeviceDisableDepthColorSync)                        \
  FUNCTION(device_get_depth_color_sync_enabled, oniDeviceGetDepthColorSyncEnabled)                 \
  FUNCTION(device_get_property, oniDeviceGetProperty)                                              \
  FUNCTION(device_set_property, oniDeviceSetProperty)                                              \
  FUNCTION(device_is_image_registration_mode_supported, oniDeviceIsImageRegistrationModeSupported) \
  FUNCTION(stream_destroy, oniStreamDestroy)                                                       \
  FUNCTION(stream_start, oniStreamStart)                                                           \
  FUNCTION(stream_stop, oniStreamStop)                                                             \
  FUNCTION(stream_read_frame, oniStreamReadFrame)                                                  \
  FUNCTION(stream_get_property, oniStreamGetProperty)                                              \
  FUNCTION(stream_set_property, oniStreamSetProperty)                                              \
  FUNCTION(frame_release, oniFrameRelease)

struct Api {
#define CAMLOC_OPENNI2_FIELD(name, symbol) decltype(&::symbol) name = nullptr;
  CAMLOC_OPENNI2_FUNCTIONS(CAMLOC_OPENNI2_FIELD)
#undef CAMLOC_OPENNI2_FIELD
};

/// A device as the library lists it.
struct DeviceEntry {
  std::string uri;
  std::string vendor;
  std::string name;
  int usb_vendor_id = 0;
  int usb_product_id = 0;
};

/// "2.2.0.33".
[[nodiscard]] std::string version_text(const OniVersion& version);

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
  void mark_gone(const std::string& uri);

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
