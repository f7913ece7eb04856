// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See openni2_library.h.
#include "drivers/openni2/openni2_library.h"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstring>

namespace camloc::openni2 {

namespace {

constexpr const char* kLibraryName = "libOpenNI2.so.0";

/// Text of a fixed-size field of the C API, which may lack its end.
template <std::size_t N>
std::string text_of(const char (&field)[N]) {
  return {field, ::strnlen(field, N)};
}

/// False, with the name in `missing`, where the library lacks it.
template <typename Function>
bool find_symbol(void* handle, const char* name, Function* function, std::string* missing) {
  *function = reinterpret_cast<Function>(::dlsym(handle, name));
  if (*function == nullptr) *missing = name;
  return *function != nullptr;
}

bool find_all(void* handle, Api* api, std::string* missing) {
  return find_symbol(handle, "oniInitialize", &api->initialize, missing) && find_symbol(handle, "oniShutdown", &api->shutdown, missing) &&
         find_symbol(handle, "oniGetVersion", &api->get_version, missing) &&
         find_symbol(handle, "oniGetExtendedError", &api->get_extended_error, missing) &&
         find_symbol(handle, "oniSetLogConsoleOutput", &api->set_log_console_output, missing) &&
         find_symbol(handle, "oniSetLogFileOutput", &api->set_log_file_output, missing) &&
         find_symbol(handle, "oniGetDeviceList", &api->get_device_list, missing) &&
         find_symbol(handle, "oniReleaseDeviceList", &api->release_device_list, missing) &&
         find_symbol(handle, "oniRegisterDeviceCallbacks", &api->register_device_callbacks, missing) &&
         find_symbol(handle, "oniUnregisterDeviceCallbacks", &api->unregister_device_callbacks, missing) &&
         find_symbol(handle, "oniWaitForAnyStream", &api->wait_for_any_stream, missing) &&
         find_symbol(handle, "oniDeviceOpen", &api->device_open, missing) &&
         find_symbol(handle, "oniDeviceClose", &api->device_close, missing) &&
         find_symbol(handle, "oniDeviceGetSensorInfo", &api->device_get_sensor_info, missing) &&
         find_symbol(handle, "oniDeviceGetInfo", &api->device_get_info, missing) &&
         find_symbol(handle, "oniDeviceCreateStream", &api->device_create_stream, missing) &&
         find_symbol(handle, "oniDeviceEnableDepthColorSync", &api->device_enable_depth_color_sync, missing) &&
         find_symbol(handle, "oniDeviceDisableDepthColorSync", &api->device_disable_depth_color_sync, missing) &&
         find_symbol(handle, "oniDeviceGetDepthColorSyncEnabled", &api->device_get_depth_color_sync_enabled, missing) &&
         find_symbol(handle, "oniDeviceGetProperty", &api->device_get_property, missing) &&
         find_symbol(handle, "oniDeviceSetProperty", &api->device_set_property, missing) &&
         find_symbol(handle, "oniDeviceIsImageRegistrationModeSupported", &api->device_is_image_registration_mode_supported, missing) &&
         find_symbol(handle, "oniStreamDestroy", &api->stream_destroy, missing) &&
         find_symbol(handle, "oniStreamStart", &api->stream_start, missing) &&
         find_symbol(handle, "oniStreamStop", &api->stream_stop, missing) &&
         find_symbol(handle, "oniStreamReadFrame", &api->stream_read_frame, missing) &&
         find_symbol(handle, "oniStreamGetProperty", &api->stream_get_property, missing) &&
         find_symbol(handle, "oniStreamSetProperty", &api->stream_set_property, missing) &&
         find_symbol(handle, "oniFrameRelease", &api->frame_release, missing);
}

Result<LoadedLibrary> load() {
  // Never closed: the library keeps threads.
  void* handle = ::dlopen(kLibraryName, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) {
    const char* why = ::dlerror();
    return Status(ErrorCode::kUnavailable, std::string("OpenNI2 cannot be loaded (") + (why != nullptr ? why : kLibraryName) +
                                               "): install the package libopenni2-0");
  }
  LoadedLibrary library;
  const link_map* map = nullptr;
  if (::dlinfo(handle, RTLD_DI_LINKMAP, &map) == 0 && map != nullptr && map->l_name != nullptr) library.path = map->l_name;
  std::string missing;
  if (!find_all(handle, &library.api, &missing)) {
    return Status(ErrorCode::kUnsupported,
                  library.path + ": has no function " + missing + "; version 2.2 of OpenNI2 is expected, as in the package libopenni2-0");
  }
  library.version = library.api.get_version();
  if (library.version.major != ONI_VERSION_MAJOR || library.version.minor < ONI_VERSION_MINOR) {
    return Status(ErrorCode::kUnsupported, library.path + ": is version " + std::to_string(library.version.major) + "." +
                                               std::to_string(library.version.minor) + "; 2.2 is expected, as in the package libopenni2-0");
  }
  return library;
}

std::string last_error_of(const Api& api) {
  const char* words = api.get_extended_error();
  std::string line(words != nullptr ? words : "");
  while (!line.empty() && (line.back() == '\n' || line.back() == '\t' || line.back() == ' ')) line.pop_back();
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
  return line.empty() ? "no reason given" : line;
}

/// The process has one library and so one session; where they are kept.
struct Shared {
  std::mutex mutex;
  std::weak_ptr<Session> session;
};

Shared& shared() {
  static Shared instance;
  return instance;
}

}  // namespace

Result<const LoadedLibrary*> load_library() {
  static std::mutex mutex;
  static std::unique_ptr<const LoadedLibrary> loaded;
  const std::lock_guard<std::mutex> lock(mutex);
  // A failure is not kept: the package may be installed while the daemon waits for its camera.
  if (loaded == nullptr) {
    Result<LoadedLibrary> result = load();
    if (!result) return result.status();
    loaded = std::make_unique<const LoadedLibrary>(std::move(result).value());
  }
  return loaded.get();
}

Result<std::shared_ptr<Session>> Session::acquire() {
  const Result<const LoadedLibrary*> library = load_library();
  if (!library) return library.status();
  const std::lock_guard<std::mutex> lock(shared().mutex);
  if (std::shared_ptr<Session> session = shared().session.lock()) return session;
  const Api& api = library.value()->api;
  api.set_log_console_output(FALSE);
  api.set_log_file_output(FALSE);
  if (api.initialize(ONI_API_VERSION) != ONI_STATUS_OK) {
    const std::string why = last_error_of(api);
    api.shutdown();  // a failed start counts as one
    return Status(ErrorCode::kUnavailable, library.value()->path + ": OpenNI2 does not start (" + why +
                                               "): it expects its drivers in the folder OpenNI2/Drivers beside it; ask `camloc doctor`");
  }
  const std::shared_ptr<Session> session(new Session(*library.value()), [](Session* expired) {
    const std::lock_guard<std::mutex> last(shared().mutex);
    delete expired;
  });
  OniDeviceCallbacks callbacks{nullptr, on_disconnected, on_state};
  if (api.register_device_callbacks(&callbacks, session.get(), &session->callbacks_) != ONI_STATUS_OK) session->callbacks_ = nullptr;
  shared().session = session;
  return session;
}

Session::~Session() {
  if (callbacks_ != nullptr) api().unregister_device_callbacks(callbacks_);
  api().shutdown();
}

std::vector<DeviceEntry> Session::devices() const {
  std::vector<DeviceEntry> result;
  OniDeviceInfo* list = nullptr;
  int count = 0;
  if (api().get_device_list(&list, &count) != ONI_STATUS_OK) return result;
  for (int i = 0; i < count; ++i) {
    result.push_back({text_of(list[i].uri), text_of(list[i].vendor), text_of(list[i].name), list[i].usbVendorId, list[i].usbProductId});
  }
  api().release_device_list(list);
  return result;
}

std::string Session::last_error() const { return last_error_of(api()); }

void Session::watch(const std::string& uri, GoneFlag gone) {
  const std::lock_guard<std::mutex> lock(mutex_);
  watches_.push_back({uri, std::move(gone)});
}

void Session::unwatch(const GoneFlag& gone) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::erase_if(watches_, [&gone](const Watch& watch) { return watch.gone == gone; });
}

void Session::mark_gone(const char* uri) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Watch& watch : watches_) {
    if (watch.uri == uri) watch.gone->store(true);
  }
}

void Session::on_disconnected(const OniDeviceInfo* info, void* cookie) {
  static_cast<Session*>(cookie)->mark_gone(text_of(info->uri).c_str());
}

void Session::on_state(const OniDeviceInfo* info, OniDeviceState state, void* cookie) {
  if (state == ONI_DEVICE_STATE_ERROR) static_cast<Session*>(cookie)->mark_gone(text_of(info->uri).c_str());
}

}  // namespace camloc::openni2
