// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers in tables and messages, by printf's format, in as many characters as they take.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>

#include "core/io/text.h"

namespace camloc::tools {

[[nodiscard, gnu::format(printf, 1, 2)]] std::string text_of(const char* format, ...);
/// The same at the end of a text.
[[gnu::format(printf, 2, 3)]] void append_text(std::string* text, const char* format, ...);

/// What %llu takes.
[[nodiscard]] constexpr unsigned long long llu(std::uint64_t value) { return value; }

using camloc::printable;

[[nodiscard]] inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

}  // namespace camloc::tools
