// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Text tables of points. There is no standard; this reads what scanners' and viewers' exports have in common.
#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <vector>

#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kSniffedBytes = std::size_t{1} << 16;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

enum class Comma { kUnused, kSeparates, kDecimal, kThousands };

/// What the commas of one line are where blanks separate too. "1,5 2,25 3" has decimal ones: one at most in each of the fields between
/// blanks, between digits, and no point anywhere. "5,334,567.12 1,250.00 3" has them for thousands.
Comma commas_of(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return Comma::kUnused;
  const auto fields = split_fields(line, " \t");
  if (fields.size() < 3) return Comma::kSeparates;
  bool has_point = line.find('.') != std::string_view::npos, is_decimal = !has_point, is_thousands = has_point;
  for (const std::string_view field : fields) {
    const std::size_t first = field.find(','), last = field.rfind(',');
    if (first == std::string_view::npos) continue;
    std::string as_point(field), bare(field);
    as_point[first] = '.';
    std::erase(bare, ',');
    const std::string_view whole = field.substr(0, field.find('.'));
    is_decimal = is_decimal && first == last && first > 0 && first + 1 < field.size() && parse_double(as_point);
    is_thousands = is_thousands && last < whole.size() && whole.size() - last == 4 && parse_double(bare);
  }
  return is_decimal ? Comma::kDecimal : is_thousands ? Comma::kThousands : Comma::kSeparates;
}

/// By the lines of numbers at the beginning of the file: one line that has it otherwise decides against decimal commas.
Comma commas_at(std::string_view start) {
  Comma commas = Comma::kUnused;
  while (!start.empty()) {
    const std::size_t end = start.find_first_of("\r\n");
    if (end == std::string_view::npos && commas != Comma::kUnused) break;  // may be cut
    const std::string_view line = trimmed(start.substr(0, end));
    const bool is_number = !line.empty() && std::string_view("0123456789-+.").find(line.front()) != std::string_view::npos;
    const Comma found = is_number ? commas_of(line) : Comma::kUnused;
    if (found == Comma::kSeparates || (found != Comma::kUnused && commas == Comma::kUnused)) commas = found;
    start.remove_prefix(end == std::string_view::npos ? start.size() : end + 1);
  }
  return commas;
}

/// Fields of a line, which look into it or into `buffer`. Where there are semicolons they separate, and a comma is the decimal sign.
std::vector<std::string_view> split(std::string_view line, Comma commas, std::string* buffer) {
  const bool has_semicolon = line.find(';') != std::string_view::npos;
  if (!has_semicolon && commas != Comma::kDecimal) return split_fields(line, " \t,");
  *buffer = line;
  std::replace(buffer->begin(), buffer->end(), ',', '.');
  return split_fields(*buffer, " \t;");
}

/// Columns named x, y and z (or easting, northing, height) in a header line.
std::optional<std::array<std::size_t, 3>> named_columns(const std::vector<std::string_view>& fields) {
  constexpr std::array<std::array<std::string_view, 5>, 3> kNames = {
      {{"x", "x[m]", "x_m", "easting", "east"}, {"y", "y[m]", "y_m", "northing", "north"}, {"z", "z[m]", "z_m", "height", "elevation"}}};
  std::array<std::size_t, 3> columns{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t column = 0;
    const auto is_axis = [&](std::string_view field) {
      std::string name = lower(field);
      std::erase(name, '"');
      return std::find(kNames[axis].begin(), kNames[axis].end(), name) != kNames[axis].end();
    };
    while (column < fields.size() && !is_axis(fields[column])) ++column;
    if (column == fields.size()) return std::nullopt;
    columns[axis] = column;
  }
  return columns;
}

/// Without its mark; nothing where the line is no comment.
std::optional<std::string_view> comment_text(std::string_view line) {
  if (line.starts_with("//")) return line.substr(2);
  if (line.starts_with('#') || line.starts_with('%')) return line.substr(1);
  return std::nullopt;
}

}  // namespace

Status read_text_cloud(CloudInput* input, CloudAccumulator* cloud) {
  std::string buffer;
  std::array<std::size_t, 3> columns = {0, 1, 2};
  std::uint64_t num_points = 0, num_promised = 0;
  bool may_be_header = true;
  const auto start = input->peek(kSniffedBytes);
  const Comma commas = commas_at({reinterpret_cast<const char*>(start.data()), start.size()});
  if (commas == Comma::kThousands) {
    return input->error(ErrorCode::kInvalid, "has commas between thousands, as in 5,334,567.12; write the numbers without");
  }
  if (commas == Comma::kDecimal) cloud->note("commas are decimal signs; blanks and tabs separate");
  for (int number = 1;; ++number) {
    const auto line = input->read_line();
    if (!line) break;
    std::string_view text = trimmed(*line);
    if (text.empty()) continue;
    const auto comment = comment_text(text);
    if (comment && !may_be_header) continue;
    const auto fields = split(comment.value_or(text), commas, &buffer);
    if (const auto point = comment ? std::nullopt : parse_point(fields, columns)) {
      cloud->add(*point);
      ++num_points;
      may_be_header = false;
      continue;
    }
    const auto count = fields.size() == 1 && (may_be_header || num_promised > 0) ? parse_int(fields[0]) : std::nullopt;
    if (!comment && count && *count >= 0 && num_points == num_promised) {  // PTS, or its next scan
      num_promised += static_cast<std::uint64_t>(*count);
      if (static_cast<std::uint64_t>(*count) > input->remaining() / 6 + 1) break;  // "x y z" takes six bytes with the line end
      continue;
    }
    if (may_be_header) {
      if (const auto named = named_columns(fields)) columns = *named;
      if (comment) continue;
      const bool is_header = std::none_of(fields.begin(), fields.end(), [](std::string_view f) { return parse_double(f).has_value(); });
      if (is_header && fields.size() >= 3) {
        may_be_header = false;
        continue;
      }
    }
    return line_error(input->name(), number, "no point (x, y, z and what else there is): " + in_quotes(text));
  }
  if (num_promised > num_points) {
    return input->truncated("it promises " + std::to_string(num_promised) + " points, " + std::to_string(num_points) + " are there");
  }
  return Status::ok();
}

}  // namespace camloc::mapping
