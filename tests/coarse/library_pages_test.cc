// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/library_pages.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

namespace camloc {
namespace {

/// Kilobytes in memory of the mapped files whose path contains `name`.
long resident_kb(const std::string& name) {
  std::ifstream maps("/proc/self/smaps");
  std::string line;
  bool is_wanted = false;
  long sum = 0;
  while (std::getline(maps, line)) {
    if (line.find('-') < line.find(' ')) is_wanted = line.find(name) != std::string::npos;
    if (is_wanted && line.starts_with("Rss:")) sum += std::stol(line.substr(4));
  }
  return sum;
}

#ifdef CAMLOC_NETWORK_PLUGIN_FILE
TEST(LibraryPages, AreGivenBackAndComeAgain) {
  void* const library = ::dlopen(CAMLOC_NETWORK_PLUGIN_FILE, RTLD_NOW | RTLD_LOCAL);
  ASSERT_NE(library, nullptr);
  const long before = resident_kb("libopencv_core");
  give_back_library_pages(library);
  const long after = resident_kb("libopencv_core");
  EXPECT_LT(after, before);
  EXPECT_NE(::dlsym(library, "camloc_network_plugin"), nullptr) << "read from the file again";
  EXPECT_NE(reinterpret_cast<void* (*)()>(::dlsym(library, "camloc_network_plugin"))(), nullptr);
  ::dlclose(library);
}
#endif

}  // namespace
}  // namespace camloc
