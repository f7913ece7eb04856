// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The new bytes or the old ones, and nothing else in the folder.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/unique_fd.h"
#include "core/io/file_bytes.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

Status replace_by(const std::string& path, const std::string& text) { return replace_file(path, std::as_bytes(std::span(text))); }

std::string text_of(const std::string& path) {
  const std::vector<std::uint8_t> bytes = bytes_of(path);
  return {bytes.begin(), bytes.end()};
}

std::size_t num_files(const TestFolder& folder) {
  const auto files = std::filesystem::directory_iterator(folder.path());
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(ReplaceFile, MakesAndReplacesAndLeavesNothingElse) {
  const TestFolder folder;
  ASSERT_TRUE(replace_by(folder / "a", "old and long"));
  EXPECT_EQ(text_of(folder / "a"), "old and long");
  ASSERT_TRUE(replace_by(folder / "a", "new"));
  EXPECT_EQ(text_of(folder / "a"), "new");
  ASSERT_TRUE(replace_by(folder / "a", ""));
  EXPECT_EQ(text_of(folder / "a"), "");
  EXPECT_EQ(num_files(folder), 1U);
}

TEST(ReplaceFile, WhoHasTheOldFileOpenKeepsIt) {
  const TestFolder folder;
  std::ifstream old_file(folder.write("a", "old"));
  ASSERT_TRUE(replace_by(folder / "a", "new"));
  std::string text;
  old_file >> text;
  EXPECT_EQ(text, "old");
}

TEST(ReplaceFile, ALeftoverOfAKilledWriterIsReplaced) {
  const TestFolder folder;
  folder.write("a." + std::to_string(::getpid()) + ".tmp", "half");
  ASSERT_TRUE(replace_by(folder / "a", "new"));
  EXPECT_EQ(num_files(folder), 1U);
}

TEST(ReplaceFile, FollowsASymbolicLink) {
  const TestFolder folder;
  folder.write("real", "old");
  std::filesystem::create_symlink("real", folder / "link");
  ASSERT_TRUE(replace_by(folder / "link", "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(text_of(folder / "real"), "new");
}

TEST(ReplaceFile, ALinkWhereOthersMayWriteIsNotFollowed) {
  const TestFolder folder;
  folder.write("shared/x", "");
  folder.write("victim", "precious");
  std::filesystem::create_symlink(folder / "victim", folder / "shared/link");
  std::filesystem::create_symlink("shared/link", folder / "mine");
  ASSERT_EQ(::chmod((folder / "shared").c_str(), 0770), 0);
  for (const std::string& path : {folder / "shared/link", folder / "mine"}) {
    const Status status = replace_by(path, "new");
    EXPECT_EQ(status.code(), ErrorCode::kIo) << path;
    EXPECT_NE(status.message().find("symbolic link"), std::string::npos) << status.message();
  }
  EXPECT_EQ(text_of(folder / "victim"), "precious");
  ASSERT_EQ(::chmod((folder / "shared").c_str(), 0750), 0);
  EXPECT_TRUE(replace_by(folder / "mine", "new")) << "link by link, where nobody else can have put them";
  EXPECT_EQ(text_of(folder / "victim"), "new");
}

TEST(ReplaceFile, LinksInACircleAreAnError) {
  const TestFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_EQ(replace_by(folder / "a", "new").code(), ErrorCode::kIo);
}

TEST(ReplaceFile, TheModeOfTheOldFileStays) {
  const TestFolder folder;
  const std::string path = folder.write("a", "old");
  for (const mode_t mode : {0600U, 0664U, 0444U}) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    ASSERT_TRUE(replace_by(path, "new"));
    struct stat info {};
    ASSERT_EQ(::stat(path.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, mode);
  }
}

TEST(ReplaceFile, TheTemporaryFileOfAWriterThatLivesIsLeftAlone) {
  const TestFolder folder;
  const std::string other = folder.write("a." + std::to_string(::getpid()) + ".tmp", "half");
  const UniqueFd writer(::open(other.c_str(), O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::flock(writer.get(), LOCK_EX), 0);
  ASSERT_TRUE(replace_by(folder / "a", "new"));
  EXPECT_EQ(text_of(folder / "a"), "new");
  EXPECT_EQ(text_of(other), "half");
}

TEST(SameFile, ByInodeOrByNameInTheSameFolder) {
  const TestFolder folder;
  const std::string a = folder.write("a", "x");
  folder.write("sub/b", "x");
  std::filesystem::create_symlink("a", folder / "link");
  std::filesystem::create_hard_link(a, folder / "hard");
  EXPECT_TRUE(is_same_file(a, folder / "sub/../a"));
  EXPECT_TRUE(is_same_file(a, folder / "link"));
  EXPECT_TRUE(is_same_file(a, folder / "hard"));
  EXPECT_FALSE(is_same_file(a, folder / "sub/b"));
  EXPECT_FALSE(is_same_file(a, folder / "new"));
  EXPECT_TRUE(is_same_file(folder / "new", folder / "sub/../new"));
  EXPECT_FALSE(is_same_file(folder / "new", folder / "newer"));
  EXPECT_FALSE(is_same_file(folder / "new", folder / "sub/new"));
  EXPECT_FALSE(is_same_file(folder / "no/new", folder / "nowhere/new"));
}

TEST(ReplaceFile, DiskFullLeavesTheOldFile) {
  const TestFolder folder;
  const std::string path = folder.write("a", "old");
  // The limit on the size of a file fails in the middle of the write, as a full disk does.
  rlimit old_limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, old_limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status status = replace_by(path, std::string(5000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  ::signal(SIGXFSZ, old_handler);

  EXPECT_EQ(status.code(), ErrorCode::kIo);
  EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(num_files(folder), 1U);
}

TEST(ReplaceFile, RefusesAFolderAndAMissingFolder) {
  const TestFolder folder;
  EXPECT_EQ(replace_by(folder.path(), "new").code(), ErrorCode::kIo);
  EXPECT_EQ(replace_by(folder / "missing/a", "new").code(), ErrorCode::kIo);
  EXPECT_EQ(num_files(folder), 0U);
}

TEST(ReplaceFile, LeavesDevicesAndPipesAlone) {
  const TestFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Status status = replace_by(pipe, "new");
  EXPECT_EQ(status.code(), ErrorCode::kIo);
  EXPECT_NE(status.message().find("no file"), std::string::npos) << status.message();
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

// In a child, because root may write anywhere and cannot come back from another user.
TEST(ReplaceFileDeathTest, UnwritableFolderLeavesTheOldFile) {
  const TestFolder folder;
  const std::string path = folder.write("a", "old");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0555), 0);
  EXPECT_EXIT(
      {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
        ::_exit(replace_by(path, "new").code() == ErrorCode::kIo ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(num_files(folder), 1U);
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
}

}  // namespace
}  // namespace camloc
