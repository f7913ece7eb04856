// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where does the path lead (links, folders, devices); a temporary file beside it; write, fsync, rename, fsync the folder.
#include "core/io/replace_file.h"

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

/// Removes the file at the end unless it was kept.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string path)
      : path_(std::move(path)), fd_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644)) {}
  ~TemporaryFile() {
    if (fd_.is_open()) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] int fd() const { return fd_.get(); }
  void keep() { fd_.reset(); }

 private:
  std::string path_;
  UniqueFd fd_;
};

}  // namespace

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
  TemporaryFile file(temporary_path);
  if (file.fd() < 0) return write_error(path, errno);
  if (const int error = write_all(file.fd(), bytes); error != 0) return write_error(path, error);
  if (::fsync(file.fd()) != 0) return write_error(path, errno);
  if (::rename(file.path().c_str(), target.c_str()) != 0) return write_error(path, errno);
  file.keep();

  // The new name must survive a power cut too. Where folders cannot be synced the rename still happened.
  const UniqueFd folder_fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder_fd.is_open() && ::fsync(folder_fd.get()) != 0 && errno == EIO) return write_error(path, EIO);
  return Status::ok();
}

}  // namespace camloc
