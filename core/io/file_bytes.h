// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole files into memory, with errors that name the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace camloc {

/// Reads a whole regular file of at most `max_bytes`. The vector's capacity is reused. kNotFound where there is no such
/// file, kIo where the system refuses, kInvalid where it is no regular file or larger.
[[nodiscard]] Status read_file_bytes(const std::string& path, std::size_t max_bytes, std::vector<std::uint8_t>* bytes);

/// The same for texts.
[[nodiscard]] Result<std::string> read_file_text(const std::string& path, std::size_t max_bytes = std::size_t{64} << 20);

}  // namespace camloc
