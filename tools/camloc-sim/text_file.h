// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes a whole file and notices a full disk.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace camloc::sim {

/// Replaces the file. kIo names the file and the reason.
[[nodiscard]] Status write_text_file(const std::string& path, std::string_view content);

}  // namespace camloc::sim
