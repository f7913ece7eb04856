// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "core/base/unique_fd.h"

namespace camloc {

namespace {

Status system_error(const std::string& path, int error) {
  const ErrorCode code = error == ENOENT || error == ENOTDIR ? ErrorCode::kNotFound : ErrorCode::kIo;
  return {code, path + ": " + std::generic_category().message(error)};
}

template <typename Bytes>
Status read_into(const std::string& path, std::size_t max_bytes, Bytes* bytes) {
  // O_NONBLOCK: opening a named pipe must not hang.
  const UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.is_open()) return system_error(path, errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return system_error(path, errno);
  if (S_ISDIR(info.st_mode)) return {ErrorCode::kInvalid, path + ": is a folder, expected a file"};
  if (!S_ISREG(info.st_mode)) return {ErrorCode::kInvalid, path + ": is not a regular file"};
  if (static_cast<std::uintmax_t>(info.st_size) > max_bytes) {
    return {ErrorCode::kInvalid, path + ": " + std::to_string(info.st_size) + " bytes, at most " + std::to_string(max_bytes) + " are read"};
  }
  bytes->resize(static_cast<std::size_t>(info.st_size));
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

/// 0 or the error number.
int write_and_rename(std::span<const std::byte> bytes, const std::string& temporary_path, const std::filesystem::path& target) {
  const UniqueFd file(::open(temporary_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!file.is_open()) return errno;
  if (const int error = write_all(file.get(), bytes); error != 0) return error;
  return ::fsync(file.get()) == 0 && ::rename(temporary_path.c_str(), target.c_str()) == 0 ? 0 : errno;
}

}  // namespace

Status read_file_bytes(const std::string& path, std::size_t max_bytes, std::vector<std::uint8_t>* bytes) {
  return read_into(path, max_bytes, bytes);
}

Result<std::string> read_file_text(const std::string& path, std::size_t max_bytes) {
  std::string text;
  if (Status status = read_into(path, max_bytes, &text); !status) return status;
  return text;
}

// Where does the path lead (links, folders, devices); a temporary file beside it; write, fsync, rename, fsync the folder.
Status replace_file(const std::string& path, std::span<const std::byte> bytes) {
  std::error_code ignored;
  std::filesystem::path target = std::filesystem::weakly_canonical(path, ignored);
  if (target.empty()) target = path;
  if (std::filesystem::is_directory(target, ignored)) return write_error(path, EISDIR);
  if (std::filesystem::exists(target, ignored) && !std::filesystem::is_regular_file(target, ignored))
    return {ErrorCode::kIo, "cannot write " + path + ": it is a device, pipe or socket and no file; choose another name"};
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";

  // The process id keeps two writers apart; a leftover of a killed one with the same id is replaced.
  const std::string temporary_path = target.string() + "." + std::to_string(::getpid()) + ".tmp";
  ::unlink(temporary_path.c_str());
  if (const int error = write_and_rename(bytes, temporary_path, target); error != 0) {
    ::unlink(temporary_path.c_str());
    return write_error(path, error);
  }

  // The new name must survive a power cut too. Where folders cannot be synced the rename still happened.
  const UniqueFd folder_fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder_fd.is_open() && ::fsync(folder_fd.get()) != 0 && errno == EIO) return write_error(path, EIO);
  return Status::ok();
}

}  // namespace camloc
