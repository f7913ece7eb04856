// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/text_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace camloc::sim {

Status write_text_file(const std::string& path, std::string_view content) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return {ErrorCode::kIo, path + ": cannot write: " + std::strerror(errno)};
  const bool is_written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  const int write_error = errno;
  const bool is_closed = std::fclose(file) == 0;
  if (is_written && is_closed) return Status::ok();
  return {ErrorCode::kIo, path + ": cannot write: " + std::strerror(is_written ? errno : write_error)};
}

}  // namespace camloc::sim
