// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See installation.h.
#include "drivers/openni2/installation.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "core/io/file_bytes.h"
#include "drivers/openni2/openni2_library.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

/// "Repository" of an OpenNI.ini; empty where it says nothing.
std::string repository_of(const fs::path& ini) {
  const Result<std::string> text = read_file_text(ini.string(), 1 << 20);
  if (!text) return {};
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    std::string line = text->substr(begin, end - begin);
    begin = end + 1;
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (line.rfind("Repository=", 0) == 0) return line.substr(11);
  }
  return {};
}

/// Where the library looks for drivers.
std::string drivers_folder_of(const std::string& library_path) {
  const std::string repository = repository_of("/etc/openni2/OpenNI.ini");
  return (fs::path(library_path).parent_path() / (repository.empty() ? "OpenNI2/Drivers" : repository)).string();
}

bool is_driver_name(const std::string& name) {
  return name.rfind("lib", 0) == 0 && name.size() > 8 && name.compare(name.size() - 5, 5, ".so.0") == 0;
}

Openni2Driver inspect_driver(const fs::path& path) {
  Openni2Driver driver{path.filename().string(), false, ""};
  // RTLD_NOLOAD: is it there, after the library has had its chance?
  void* handle = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD);
  driver.is_loaded = handle != nullptr;
  if (handle != nullptr) {
    ::dlclose(handle);
    return driver;
  }
  // The reason is the loader's, or the driver has loaded and lacks what a driver must have.
  handle = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const char* why = handle == nullptr ? ::dlerror() : nullptr;
  driver.problem = handle == nullptr ? (why != nullptr ? why : "cannot be loaded") : "was refused by the library";
  if (handle != nullptr) ::dlclose(handle);
  return driver;
}

std::vector<Openni2Driver> inspect_drivers(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  std::vector<Openni2Driver> drivers;
  for (const std::string& name : names) {
    if (is_driver_name(name)) {
      drivers.push_back(inspect_driver(fs::path(folder) / name));
    } else if (name.find(".so") != std::string::npos && std::find(names.begin(), names.end(), name + ".0") == names.end()) {
      drivers.push_back({name, false,
                         "its name does not end in .so.0, so Debian's OpenNI2 passes it over: add a symbolic link " +
                             name.substr(0, name.find(".so")) + ".so.0"});
    }
  }
  return drivers;
}

}  // namespace

Openni2Installation inspect_openni2() {
  Openni2Installation result;
  const Result<const openni2::LoadedLibrary*> library = openni2::load_library();
  if (!library) {
    result.problem = library.status().message();
    return result;
  }
  result.is_library_found = true;
  result.library_path = library.value()->path;
  const OniVersion& version = library.value()->version;
  result.version = std::to_string(version.major) + "." + std::to_string(version.minor) + "." + std::to_string(version.maintenance) + "." +
                   std::to_string(version.build);
  result.drivers_folder = drivers_folder_of(result.library_path);
  const Result<std::shared_ptr<openni2::Session>> session = openni2::Session::acquire();
  result.is_started = session.is_ok();
  if (!session) result.problem = session.status().message();
  result.drivers = inspect_drivers(result.drivers_folder);
  if (session && std::none_of(result.drivers.begin(), result.drivers.end(), [](const Openni2Driver& driver) { return driver.is_loaded; })) {
    result.problem = result.drivers_folder + ": no driver was loaded from here";
  }
  if (!session) return result;
  for (const openni2::DeviceEntry& entry : (*session)->devices()) {
    char usb_id[16];
    std::snprintf(usb_id, sizeof(usb_id), "%04x:%04x", static_cast<unsigned>(entry.usb_vendor_id) & 0xFFFFU,
                  static_cast<unsigned>(entry.usb_product_id) & 0xFFFFU);
    result.devices.push_back({entry.uri, entry.vendor, entry.name, usb_id});
  }
  return result;
}

CameraListing listing_of(const Openni2Installation& openni2) {
  CameraListing listing;
  listing.problem = openni2.problem;
  if (!openni2.is_library_found) {
    listing.advice = "sudo apt install libopenni2-0";
    return listing;
  }
  const auto num_loaded =
      std::count_if(openni2.drivers.begin(), openni2.drivers.end(), [](const Openni2Driver& driver) { return driver.is_loaded; });
  if (!openni2.is_started || num_loaded == 0) {
    if (listing.problem.empty()) listing.problem = "no driver in " + openni2.drivers_folder + " was loaded";
    listing.advice =
        "ls " + openni2.drivers_folder + "; drivers are called lib*.so.0; Repository= in /etc/openni2/OpenNI.ini names another folder";
    return listing;
  }
  listing.searched = "OpenNI2 " + openni2.version + ", " + std::to_string(num_loaded) + " drivers in " + openni2.drivers_folder;
  listing.advice = "plug the camera in and see 'usb rights'; a Kinect V1 is kinect://, not openni2://";
  for (const Openni2Device& device : openni2.devices)
    listing.cameras.push_back({"openni2://" + device.uri, device.vendor + " " + device.name, "USB id " + device.usb_id, ""});
  return listing;
}

CameraListing list_openni2_cameras(const SystemFolders& /*folders*/) { return listing_of(inspect_openni2()); }

}  // namespace camloc
