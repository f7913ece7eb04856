// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Small text readers that do not depend on the locale: lines of a table with '#' comments, fields, numbers, stamps.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace camloc {

struct TextLine {
  std::string_view text;  ///< without line end and surrounding blanks
  int number = 0;         ///< from 1
};

/// Without blanks, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Lines that are neither empty nor start with '#'. The views look into `text`.
[[nodiscard]] std::vector<TextLine> content_lines(std::string_view text);
/// Parts between any of `separators`; empty parts are kept out.
[[nodiscard]] std::vector<std::string_view> split_fields(std::string_view text, std::string_view separators = " \t,");
/// The whole text as a decimal number ("nan" and "inf" are numbers here).
[[nodiscard]] std::optional<double> parse_double(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> parse_int(std::string_view text);
/// Decimal seconds to nanoseconds. Digits are taken as they are: a double holds epoch seconds only to 0.2 us.
[[nodiscard]] std::optional<std::int64_t> parse_seconds_ns(std::string_view text);

/// Lines "timestamp a b ...": `columns` lists their names, `value` says what an `a` or `b` is, of at most `largest` in size. Stamps,
/// decimal seconds, ascend. Errors name `path` and line; `on_row` gives its own without.
using StampedRowReader = std::function<Status(std::int64_t stamp_ns, std::span<const double> values)>;
[[nodiscard]] Status read_stamped_rows(std::string_view text, const std::string& path, const std::string& columns, const char* value,
                                       double largest, const StampedRowReader& on_row);

/// "path:line: what".
[[nodiscard]] Status line_error(const std::string& path, int line, const std::string& what);
/// In double quotes, as TOML and JSON want a text: quotes, backslashes and control characters are escaped. `is_ascii`: so are all bytes
/// that are no ASCII, as if they were Latin-1 (paths may hold any).
[[nodiscard]] std::string in_double_quotes(std::string_view text, bool is_ascii = false);
/// Text from outside, fit for a terminal and for one line: what may drive a terminal or reorder a line becomes '?', byte by byte.
/// That is control characters, C1 ones in UTF-8 (U+009B starts an escape sequence, too), line separators, marks that turn the direction
/// of writing, and all bytes that are no UTF-8.
void make_printable(std::span<char> text);
[[nodiscard]] inline std::string printable(std::string text) {
  make_printable(text);
  return text;
}
/// Text from outside, fit for a one-line message: quoted, cut at 40 bytes, printable.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace camloc
