// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole files into memory and back, with errors that name the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace camloc {

/// Reads a whole regular file of at most `max_bytes`. The vector's capacity is reused. kNotFound where there is no such
/// file, kIo where the system refuses, kInvalid where it is no regular file or larger.
[[nodiscard]] Status read_file_bytes(const std::string& path, std::size_t max_bytes, std::vector<std::uint8_t>* bytes);

/// The same for texts.
[[nodiscard]] Result<std::string> read_file_text(const std::string& path, std::size_t max_bytes = std::size_t{64} << 20);

/// Replaces a file as a whole or not at all: whoever opens the path sees the old bytes or the new ones, also after a power cut;
/// whoever has the old file mapped keeps it.
///
/// Writes a temporary file in the folder of `path`, fsyncs it, renames it and fsyncs the folder. A symbolic link is
/// followed. The file gets mode 0644 less the umask.
/// Errors: kIo (disk full, permission, no such folder, a device instead of a file); `path` is untouched then and the temporary file is
/// gone.
[[nodiscard]] Status replace_file(const std::string& path, std::span<const std::byte> bytes);
[[nodiscard]] inline Status replace_file(const std::string& path, std::string_view text) {
  return replace_file(path, std::as_bytes(std::span(text)));
}

}  // namespace camloc
