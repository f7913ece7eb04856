// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "core/base/unique_fd.h"

namespace camloc {

namespace {

Status system_error(const std::string& path, int error) {
  const ErrorCode code = error == ENOENT || error == ENOTDIR ? ErrorCode::kNotFound : ErrorCode::kIo;
  return {code, path + ": " + std::generic_category().message(error)};
}

enum class Larger : std::uint8_t { kIsRefused, kIsCut };

template <typename Bytes>
Status read_into(const std::string& path, std::size_t max_bytes, Larger larger, Bytes* bytes) {
  // O_NONBLOCK: opening a named pipe must not hang.
  const UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) return system_error(path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return system_error(path, errno);
  if (S_ISDIR(info.st_mode)) return {ErrorCode::kInvalid, path + ": is a folder, expected a file"};
  if (!S_ISREG(info.st_mode)) return {ErrorCode::kInvalid, path + ": is not a regular file"};
  if (larger == Larger::kIsRefused && static_cast<std::uintmax_t>(info.st_size) > max_bytes) {
    return {ErrorCode::kInvalid, path + ": " + std::to_string(info.st_size) + " bytes, at most " + std::to_string(max_bytes) + " are read"};
  }
  bytes->resize(std::min(static_cast<std::size_t>(info.st_size), max_bytes));
  std::size_t done = 0;
  while (done < bytes->size()) {
    const ssize_t count = ::read(file.get(), bytes->data() + done, bytes->size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(path, errno);
    if (count == 0) break;  // became shorter meanwhile
    done += static_cast<std::size_t>(count);
  }
  bytes->resize(done);
  return Status::ok();
}

Status write_error(const std::string& path, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return {ErrorCode::kIo, "cannot write " + path + ": " + std::strerror(error) + "; " +
                              (is_full ? "free some space; the old file is unchanged" : "check the folder and its permissions")};
}

/// 0 or the error number.
int write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

/// A file that no other process writes to, beside `target`; its lock ends with it.
struct TemporaryFile {
  std::string path;
  UniqueFd fd;
};

/// The leftover of a killed writer is replaced, the file of one that lives (the same process id in another container) is left alone.
/// `error` is that of the system where there is none.
std::optional<TemporaryFile> open_temporary(const std::string& target, int* error) {
  constexpr int kMaxWriters = 100;
  for (int i = 0; i < kMaxWriters; ++i) {
    TemporaryFile file{target + "." + std::to_string(::getpid()) + (i == 0 ? "" : "." + std::to_string(i)) + ".tmp", UniqueFd()};
    const UniqueFd old(::open(file.path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (old.is_open() && ::flock(old.get(), LOCK_EX | LOCK_NB) != 0) continue;
    ::unlink(file.path.c_str());
    file.fd.reset(::open(file.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
    if (file.fd.is_open() && ::flock(file.fd.get(), LOCK_EX | LOCK_NB) == 0) return file;
    *error = errno;
    if (errno != EEXIST && errno != EWOULDBLOCK) return std::nullopt;
  }
  return std::nullopt;
}

/// What others may do with the old file they may do with the new one.
void take_over_permissions(const std::string& target, int fd) {
  struct stat old {};
  if (::stat(target.c_str(), &old) != 0) return;
  [[maybe_unused]] const int group = ::fchown(fd, static_cast<uid_t>(-1), old.st_gid);  // where the user is in that group
  ::fchmod(fd, old.st_mode & 0777U);
}

/// 0 or the error number.
int write_and_rename(std::span<const std::byte> bytes, const TemporaryFile& file, const std::string& target, bool is_synced) {
  if (const int error = write_all(file.fd.get(), bytes); error != 0) return error;
  take_over_permissions(target, file.fd.get());
  if (is_synced && ::fsync(file.fd.get()) != 0) return errno;
  return ::rename(file.path.c_str(), target.c_str()) == 0 ? 0 : errno;
}

std::string folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

/// Nobody but the user and root can have put a link there.
bool is_folder_ours(const std::string& folder) {
  struct stat info {};
  if (::stat(folder.c_str(), &info) != 0) return false;
  return (info.st_uid == ::geteuid() || info.st_uid == 0) && (info.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

Status read_file_bytes(const std::string& path, std::size_t max_bytes, std::vector<std::uint8_t>* bytes) {
  return read_into(path, max_bytes, Larger::kIsRefused, bytes);
}

Status read_file_prefix(const std::string& path, std::size_t num_bytes, std::vector<std::uint8_t>* bytes) {
  return read_into(path, num_bytes, Larger::kIsCut, bytes);
}

Result<std::string> read_file_text(const std::string& path, std::size_t max_bytes) {
  std::string text;
  if (Status status = read_into(path, max_bytes, Larger::kIsRefused, &text); !status) return status;
  return text;
}

// Link by link, because each may stand in another folder.
Result<std::string> resolve_output(const std::string& path) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::string target = path;
  std::error_code error;
  for (int i = 0; std::filesystem::is_symlink(target, error); ++i) {
    if (i == kMaxLinks) return write_error(path, ELOOP);
    if (!is_folder_ours(folder_of(target)))
      return Status(ErrorCode::kIo,
                    "cannot write " + path + ": it is a symbolic link in a folder that others may write to; name its target");
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) return write_error(path, error.value());
    target = next.is_absolute() ? next.string() : (std::filesystem::path(folder_of(target)) / next).string();
  }
  if (std::filesystem::is_directory(target, error)) return write_error(path, EISDIR);
  if (std::filesystem::exists(target, error) && !std::filesystem::is_regular_file(target, error))
    return Status(ErrorCode::kIo, "cannot write " + path + ": it is a device, pipe or socket and no file; choose another name");
  return target;
}

bool is_same_file(const std::string& a, const std::string& b) {
  const auto inode_of = [](const std::string& path) -> std::optional<std::pair<dev_t, ino_t>> {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0) return std::nullopt;
    return std::pair(info.st_dev, info.st_ino);
  };
  const auto file_a = inode_of(a), file_b = inode_of(b);
  if (file_a || file_b) return file_a == file_b;
  const auto folder_a = inode_of(folder_of(a)), folder_b = inode_of(folder_of(b));
  return folder_a && folder_a == folder_b && std::filesystem::path(a).filename() == std::filesystem::path(b).filename();
}

// Where does the path lead; a temporary file beside it; write, fsync, rename, fsync the folder.
Status replace_file(const std::string& path, std::span<const std::byte> bytes, bool is_synced) {
  const Result<std::string> target = resolve_output(path);
  if (!target) return target.status();
  int error = EEXIST;
  const std::optional<TemporaryFile> file = open_temporary(*target, &error);
  if (!file) return write_error(path, error);
  error = write_and_rename(bytes, *file, *target, is_synced);
  if (error != 0) {
    ::unlink(file->path.c_str());
    return write_error(path, error);
  }
  if (!is_synced) return Status::ok();
  // The new name must survive a power cut too. Where folders cannot be synced the rename still happened.
  const UniqueFd folder_fd(::open(folder_of(*target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder_fd.is_open() && ::fsync(folder_fd.get()) != 0 && errno == EIO) return write_error(path, EIO);
  return Status::ok();
}

}  // namespace camloc
