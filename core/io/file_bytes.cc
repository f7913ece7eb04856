// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See file_bytes.h.
#include "core/io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
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

}  // namespace

Status read_file_bytes(const std::string& path, std::size_t max_bytes, std::vector<std::uint8_t>* bytes) {
  return read_into(path, max_bytes, bytes);
}

Result<std::string> read_file_text(const std::string& path, std::size_t max_bytes) {
  std::string text;
  if (Status status = read_into(path, max_bytes, &text); !status) return status;
  return text;
}

}  // namespace camloc
