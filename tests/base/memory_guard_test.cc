// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/memory_guard.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace camloc {
namespace {

// Nobody catches what it throws: here GoogleTest would.
void exhaust_memory() noexcept {
  install_memory_guard("test: out of memory; give it more\n");
  const rlimit limit{256 << 20, 256 << 20};
  setrlimit(RLIMIT_AS, &limit);
  std::vector<std::vector<char>> blocks;
  while (true) blocks.emplace_back(std::size_t{1} << 20, 'x');
}

// Sanitizers reserve more addresses than any limit allows.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(MemoryGuard, EndsWithOneLineInAnyThread) {
  EXPECT_EXIT(exhaust_memory(), ::testing::ExitedWithCode(1), "^test: out of memory; give it more\n$");
  EXPECT_EXIT(std::thread(exhaust_memory).join(), ::testing::ExitedWithCode(1), "^test: out of memory; give it more\n$");
}
#endif

TEST(MemoryGuard, TakesExceptionsOfExhaustionThatNobodyCatches) {
  const auto uncaught = [](const auto& exception) {
    install_memory_guard("test: out of memory\n");
    std::thread([&] { throw exception; }).join();
  };
  EXPECT_EXIT(uncaught(std::bad_alloc()), ::testing::ExitedWithCode(1), "^test: out of memory\n$");
  EXPECT_EXIT(uncaught(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))), ::testing::ExitedWithCode(1),
              "^test: out of memory\n$");
  EXPECT_EXIT(uncaught(std::logic_error("a bug")), ::testing::KilledBySignal(SIGABRT), "");
}

}  // namespace
}  // namespace camloc
