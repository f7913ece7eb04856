// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See thread_allocations.h.
#include "tests/openni2/thread_allocations.h"

#include <dlfcn.h>

#include <cstdlib>
#include <cstring>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
namespace camloc::testing {
bool can_count_thread_allocations() { return false; }
std::uint64_t num_thread_allocations() { return 0; }
}  // namespace camloc::testing
#else
namespace {
thread_local std::uint64_t allocation_count = 0;

void count(void* caller) {
  Dl_info module{};
  const bool is_library =
      ::dladdr(caller, &module) != 0 && module.dli_fname != nullptr && std::strstr(module.dli_fname, "libOpenNI2") != nullptr;
  if (!is_library) ++allocation_count;
}
}  // namespace

void* operator new(std::size_t size) {
  count(__builtin_return_address(0));
  if (void* block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

namespace camloc::testing {
bool can_count_thread_allocations() { return true; }
std::uint64_t num_thread_allocations() { return allocation_count; }
}  // namespace camloc::testing
#endif
