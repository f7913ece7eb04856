// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/site/table_row.h"

#include <algorithm>

#include "core/io/text.h"

namespace camloc::mapping {
namespace {

bool is_quote(char c) { return c == '"' || c == '\''; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A '#' inside of a word is part of a name.
std::string_view without_comment(std::string_view line) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '#' && (line[i - 1] == ' ' || line[i - 1] == '\t')) return trimmed(line.substr(0, i));
  }
  return line;
}

/// The end of the field that begins here. A quote at its begin closes before a separator or at the end of the line; anywhere else it is an
/// apostrophe or inches.
std::size_t field_end(std::string_view text, std::string_view separators) {
  const std::size_t begin = std::min(text.find_first_not_of(" \t"), text.size());
  if (begin < text.size() && is_quote(text[begin])) {
    for (std::size_t close = text.find(text[begin], begin + 1); close != std::string_view::npos;
         close = text.find(text[begin], close + 1)) {
      const std::size_t next = text.find_first_not_of(' ', close + 1);
      if (next == std::string_view::npos) return text.size();
      if (separators.find(text[next]) != std::string_view::npos || separators.find(text[close + 1]) != std::string_view::npos) {
        return std::min(text.find_first_of(separators, close + 1), text.size());
      }
    }
  }
  return std::min(text.find_first_of(separators), text.size());
}

std::string_view unquoted(std::string_view field) {
  field = trimmed(field);
  const bool is_quoted = field.size() >= 2 && field.front() == field.back() && is_quote(field.front());
  return is_quoted ? trimmed(field.substr(1, field.size() - 2)) : field;
}

Row fields_between(std::string_view line, std::string_view separators) {
  Row row;
  while (!line.empty()) {
    const std::size_t end = field_end(line, separators);
    if (const std::string_view field = unquoted(line.substr(0, end)); !field.empty()) row.push_back(field);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return row;
}

/// "1,5" as a whole field: a number of the language of the program that wrote it.
bool is_comma_number(std::string_view field) {
  const std::size_t comma = field.find(',');
  if (comma == std::string_view::npos || field.find_first_not_of("0123456789+-,eE") != std::string_view::npos) return false;
  return field.rfind(',') == comma && comma + 1 < field.size() && is_digit(field[comma + 1]) && field.find_first_of("0123456789") < comma;
}

/// The fields with decimal points, in `buffer`. Only where no field has a point already.
Row with_decimal_points(const Row& row, std::string* buffer) {
  const bool has_point = std::any_of(row.begin(), row.end(), [](std::string_view f) { return parse_double(f) && f.find('.') != f.npos; });
  if (has_point || std::none_of(row.begin(), row.end(), is_comma_number)) return row;
  buffer->clear();
  for (const std::string_view field : row) {
    *buffer += field;
    if (is_comma_number(field)) (*buffer)[buffer->size() - field.size() + field.find(',')] = '.';
  }
  Row result;
  std::size_t begin = 0;
  for (const std::string_view field : row) {
    result.push_back(std::string_view(*buffer).substr(begin, field.size()));
    begin += field.size();
  }
  return result;
}

}  // namespace

bool has_split_name(std::string_view line, const Row& row) {
  if (row.size() < 3 || without_comment(line).find_first_of("\t;,\"'") != std::string_view::npos) return false;
  const auto is_fraction = [](std::string_view field) { return field.find('.') != std::string_view::npos; };
  return std::all_of(row[1].begin(), row[1].end(), is_digit) && std::all_of(row.begin() + 2, row.end(), is_fraction);
}

Row split_row(std::string_view line, std::size_t min_fields, std::string* buffer) {
  line = without_comment(line);
  for (const char separator : {';', '\t', ','}) {
    if (line.find(separator) == std::string_view::npos) continue;
    Row row = fields_between(line, std::string_view(&separator, 1));
    if (row.size() >= min_fields) return separator == ',' ? row : with_decimal_points(row, buffer);
    break;
  }
  return fields_between(line, " \t,;");
}

}  // namespace camloc::mapping
