// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A page that vanished under a mapping reads as zeros and marks the mapping; any other SIGBUS does what it did before.
#include "core/map/mapping_guard.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <vector>

#include "core/base/unique_fd.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

/// A mapped file of `pages` pages full of ones.
class MappedFile {
 public:
  explicit MappedFile(std::size_t pages) : bytes_(pages * page_bytes()), fd_(::memfd_create("guard_test", MFD_CLOEXEC)) {
    const std::vector<char> ones(bytes_, 1);
    EXPECT_EQ(::write(fd_.get(), ones.data(), bytes_), static_cast<ssize_t>(bytes_));
    begin_ = static_cast<const volatile char*>(::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, fd_.get(), 0));
  }
  ~MappedFile() { ::munmap(const_cast<char*>(begin_), bytes_); }
  static std::size_t page_bytes() { return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)); }
  [[nodiscard]] const void* begin() const { return const_cast<const char*>(begin_); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] char at_page(std::size_t page) const { return begin_[page * page_bytes()]; }
  void truncate_to_page(std::size_t page) { EXPECT_EQ(::ftruncate(fd_.get(), static_cast<off_t>(page * page_bytes())), 0); }

 private:
  std::size_t bytes_;
  UniqueFd fd_;
  const volatile char* begin_ = nullptr;
};

TEST(MappingGuard, TruncatedPagesReadAsZeros) {
  ASSERT_TRUE(install_mapping_guard());
  MappedFile file(4);
  const MappingGuard guard(file.begin(), file.bytes());
  ASSERT_TRUE(guard.is_registered());
  EXPECT_EQ(file.at_page(3), 1);
  file.truncate_to_page(1);
  EXPECT_FALSE(guard.is_damaged());
  EXPECT_EQ(file.at_page(0), 1);
  EXPECT_FALSE(guard.is_damaged());
  EXPECT_EQ(file.at_page(2), 0);
  EXPECT_TRUE(guard.is_damaged());
  EXPECT_EQ(file.at_page(3), 0);
  EXPECT_EQ(file.at_page(0), 1);
}

TEST(MappingGuard, MarksOnlyTheMappingThatFailed) {
  ASSERT_TRUE(install_mapping_guard());
  MappedFile good(2), bad(2);
  const MappingGuard good_guard(good.begin(), good.bytes());
  const MappingGuard bad_guard(bad.begin(), bad.bytes());
  bad.truncate_to_page(0);
  EXPECT_EQ(bad.at_page(1), 0);
  EXPECT_TRUE(bad_guard.is_damaged());
  EXPECT_FALSE(good_guard.is_damaged());
}

TEST(MappingGuard, MovesAndFreesItsPlace) {
  MappedFile file(1);
  for (int round = 0; round < 3 * kMaxGuardedMappings; ++round) {
    MappingGuard first(file.begin(), file.bytes());
    ASSERT_TRUE(first.is_registered());
    MappingGuard second = std::move(first);
    EXPECT_FALSE(first.is_registered());  // NOLINT(bugprone-use-after-move)
    ASSERT_TRUE(second.is_registered());
    first = std::move(second);
    ASSERT_TRUE(first.is_registered());
  }
}

TEST(MappingGuard, FullTableLeavesTheRestUnguarded) {
  MappedFile file(1);
  std::vector<MappingGuard> guards;
  for (int i = 0; i < kMaxGuardedMappings; ++i) guards.emplace_back(file.begin(), file.bytes());
  EXPECT_TRUE(guards.back().is_registered());
  const MappingGuard extra(file.begin(), file.bytes());
  EXPECT_FALSE(extra.is_registered());
  EXPECT_FALSE(extra.is_damaged());
  guards.pop_back();
  EXPECT_TRUE(MappingGuard(file.begin(), file.bytes()).is_registered());
}

// Each of these runs in a fresh process: the guard is installed once in a process.
TEST(MappingGuardDeathTest, UnregisteredMappingStillDies) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        install_mapping_guard();
        MappedFile file(2);
        { const MappingGuard gone(file.begin(), file.bytes()); }
        file.truncate_to_page(0);
        static_cast<void>(file.at_page(1));
      },
      "");
}

TEST(MappingGuardDeathTest, SentSignalStillKills) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        install_mapping_guard();
        ::raise(SIGBUS);
      },
      "");
}

void exit_with_42(int) { ::_exit(42); }
void exit_with_43(int, siginfo_t*, void*) { ::_exit(43); }

TEST(MappingGuardDeathTest, ChainsToAPlainHandler) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        ::signal(SIGBUS, exit_with_42);
        install_mapping_guard();
        install_mapping_guard();
        MappedFile file(2);
        file.truncate_to_page(0);
        static_cast<void>(file.at_page(1));
      },
      ::testing::ExitedWithCode(42), "");
}

TEST(MappingGuardDeathTest, ChainsToAnInformedHandler) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        struct sigaction action {};
        action.sa_sigaction = exit_with_43;
        action.sa_flags = SA_SIGINFO;
        ::sigaction(SIGBUS, &action, nullptr);
        install_mapping_guard();
        ::raise(SIGBUS);
      },
      ::testing::ExitedWithCode(43), "");
}

TEST(MappingGuard, MapTruncatedWhileOpenIsDamaged) {
  ASSERT_TRUE(install_mapping_guard());
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  ASSERT_TRUE(write_map(testing::make_synthetic_map({.num_landmarks = 2000}), path).is_ok());
  const Result<MapView> view = MapView::open(path);
  ASSERT_TRUE(view.is_ok()) << view.status().message();
  std::filesystem::resize_file(path, 0);
  EXPECT_FALSE(view->is_damaged());
  std::uint64_t sum = 0;
  for (const auto& descriptor : view->descriptors()) sum += descriptor.bits[0];
  EXPECT_EQ(sum, 0U);
  EXPECT_TRUE(view->is_damaged());
  std::vector<std::uint32_t> list(view->info().max_keyframe_landmarks);
  EXPECT_EQ(view->keyframe_landmarks(0, list), list.size());
  EXPECT_EQ(MapView::open(path).status().code(), ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace camloc
