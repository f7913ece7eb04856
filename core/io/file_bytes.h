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

/// The first `num_bytes` of a regular file, or all of it where it is shorter.
[[nodiscard]] Status read_file_prefix(const std::string& path, std::size_t num_bytes, std::vector<std::uint8_t>* bytes);

/// Replaces a file as a whole or not at all: whoever opens the path sees the old bytes or the new ones, also after a power cut;
/// whoever has the old file mapped keeps it.
///
/// Writes a temporary file in the folder of `path`, that no other writer has, fsyncs it, renames it and fsyncs the folder. A symbolic
/// link is followed where nobody else can have put it there: see resolve_output(). A file that is replaced hands its mode and group on;
/// a new one gets mode 0644 less the umask. Without `is_synced` there is no fsync: for files that come by the thousand.
/// Errors: kIo (disk full, permission, no such folder, a device instead of a file, a link that is not followed); `path` is untouched
/// then and the temporary file is gone.
[[nodiscard]] Status replace_file(const std::string& path, std::span<const std::byte> bytes, bool is_synced = true);
[[nodiscard]] inline Status replace_file(const std::string& path, std::string_view text) {
  return replace_file(path, std::as_bytes(std::span(text)));
}

/// The file that writing to `path` replaces or makes: where a link leads, when it stands in a folder that is the user's or root's and
/// that nobody else may write to. In another one, whoever may write there could lead the output to any file of the user. kIo: such a
/// link, a folder, or a device, pipe or socket.
[[nodiscard]] Result<std::string> resolve_output(const std::string& path);

/// Whether two paths name one file: the same inode, or the same name in one folder where there is no file yet.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

}  // namespace camloc
