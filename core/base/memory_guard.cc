// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/memory_guard.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

namespace camloc {
namespace {

const char* g_last_words = "out of memory\n";

/// With what needs no memory.
[[noreturn]] void say_last_words() {
  const ssize_t ignored = ::write(STDERR_FILENO, g_last_words, std::strlen(g_last_words));
  static_cast<void>(ignored);
  ::_exit(1);
}

[[noreturn]] void end() {
  if (const std::exception_ptr exception = std::current_exception()) {
    try {
      std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) { say_last_words(); } catch (const std::system_error& error) {
      if (error.code() == std::errc::resource_unavailable_try_again || error.code() == std::errc::not_enough_memory) say_last_words();
    } catch (...) {}  // ours to fix: the core dump tells where
  }
  std::abort();
}

}  // namespace

void install_memory_guard(const char* last_words) {
  g_last_words = last_words;
  std::set_terminate(end);
}

}  // namespace camloc
