// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Replaces a file as a whole or not at all. Whoever opens the path sees the old bytes or the new ones, also after a
// power cut; whoever has the old file mapped keeps it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace camloc {

/// Writes a temporary file in the folder of `path`, fsyncs it, renames it and fsyncs the folder. A symbolic link is
/// followed. The file gets mode 0644 less the umask.
/// Errors: kIo (disk full, permission, no such folder, a device instead of a file); `path` is untouched then and the temporary file is
/// gone.
[[nodiscard]] Status replace_file(const std::string& path, std::span<const std::byte> bytes);
[[nodiscard]] inline Status replace_file(const std::string& path, std::string_view text) {
  return replace_file(path, std::as_bytes(std::span(text)));
}

}  // namespace camloc
