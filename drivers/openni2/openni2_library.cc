// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
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

/// The name of a function that the library lacks; nullptr where it has all.
const char* find_functions(void* handle, Api* api) {
#define CAMLOC_OPENNI2_FIND(name, symbol)                                      \
  api->name = reinterpret_cast<decltype(api->name)>(::dlsym(handle, #symbol)); \
  if (api->name == nullptr) return #symbol;
  CAMLOC_OPENNI2_FUNCTIONS(CAMLOC_OPENNI2_FIND)
#undef CAMLOC_OPENNI2_FIND
  return nullptr;
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
  if (const char* missing = find_functions(handle, &library.api); missing != nullptr) {
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

}  // namespace

std::string version_text(const OniVersion& version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.maintenance) + "." +
         std::to_string(version.build);
}

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
  // The process has one library and so one session.
  static std::mutex mutex;
  static std::weak_ptr<Session> current;
  const std::lock_guard<std::mutex> lock(mutex);
  if (std::shared_ptr<Session> session = current.lock()) return session;
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
    const std::lock_guard<std::mutex> last(mutex);
    delete expired;
  });
  const auto on_disconnected = [](const OniDeviceInfo* info, void* cookie) {
    static_cast<Session*>(cookie)->mark_gone(text_of(info->uri));
  };
  const auto on_state = [](const OniDeviceInfo* info, OniDeviceState state, void* cookie) {
    if (state == ONI_DEVICE_STATE_ERROR) static_cast<Session*>(cookie)->mark_gone(text_of(info->uri));
  };
  OniDeviceCallbacks callbacks{nullptr, on_disconnected, on_state};
  if (api.register_device_callbacks(&callbacks, session.get(), &session->callbacks_) != ONI_STATUS_OK) session->callbacks_ = nullptr;
  current = session;
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

void Session::mark_gone(const std::string& uri) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Watch& watch : watches_) {
    if (watch.uri == uri) watch.gone->store(true);
  }
}

}  // namespace camloc::openni2
