// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/openni2/installation.h"

#include <dlfcn.h>

#include <cstdio>
#include <filesystem>
#include <system_error>

#include "core/io/file_bytes.h"
#include "core/io/text.h"
#include "drivers/openni2/openni2_library.h"

namespace camloc {

namespace {

namespace fs = std::filesystem;

/// "Repository" of an OpenNI.ini; empty where it says nothing.
std::string repository_of(const fs::path& ini) {
  const Result<std::string> text = read_file_text(ini.string(), 1 << 20);
  if (!text) return {};
  for (const TextLine& content : content_lines(*text)) {
    std::string line(content.text);
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    if (line.starts_with("Repository=")) return line.substr(11);
  }
  return {};
}

/// Where the library looks for drivers.
std::string drivers_folder_of(const std::string& library_path) {
  const std::string repository = repository_of("/etc/openni2/OpenNI.ini");
  return (fs::path(library_path).parent_path() / (repository.empty() ? "OpenNI2/Drivers" : repository)).string();
}

/// By its name one that Debian's library looks at, and loaded by now.
bool is_loaded_driver(const fs::path& path) {
  const std::string name = path.filename().string();
  if (!name.starts_with("lib") || name.size() <= 8 || !name.ends_with(".so.0")) return false;
  void* handle = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD);
  if (handle != nullptr) ::dlclose(handle);
  return handle != nullptr;
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
  result.version = openni2::version_text(library.value()->version);
  result.drivers_folder = drivers_folder_of(library.value()->path);
  const Result<std::shared_ptr<openni2::Session>> session = openni2::Session::acquire();
  result.is_started = session.is_ok();
  if (!session) result.problem = session.status().message();
  std::error_code error;
  for (fs::directory_iterator entry(result.drivers_folder, error), end; !error && entry != end; entry.increment(error))
    result.num_drivers += is_loaded_driver(entry->path()) ? 1 : 0;
  if (!session) return result;
  for (const openni2::DeviceEntry& entry : (*session)->devices()) {
    char usb_id[16];
    std::snprintf(usb_id, sizeof(usb_id), "%04x:%04x", static_cast<unsigned>(entry.usb_vendor_id) & 0xFFFFU,
                  static_cast<unsigned>(entry.usb_product_id) & 0xFFFFU);
    result.cameras.push_back({"openni2://" + entry.uri, entry.vendor + " " + entry.name, std::string("USB id ") + usb_id, ""});
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
  if (!openni2.is_started || openni2.num_drivers == 0) {
    if (listing.problem.empty()) listing.problem = openni2.drivers_folder + ": no driver was loaded from here";
    listing.advice =
        "ls " + openni2.drivers_folder + "; drivers are called lib*.so.0; Repository= in /etc/openni2/OpenNI.ini names another folder";
    return listing;
  }
  listing.searched = "OpenNI2 " + openni2.version + ", " + std::to_string(openni2.num_drivers) + " drivers in " + openni2.drivers_folder;
  listing.advice = "plug the camera in and see 'usb rights'; a Kinect V1 is kinect://, not openni2://";
  listing.cameras = openni2.cameras;
  return listing;
}

CameraListing list_openni2_cameras(const SystemFolders& /*folders*/) { return listing_of(inspect_openni2()); }

}  // namespace camloc
