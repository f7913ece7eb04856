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

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// Fields of a line, which look into it or into `buffer`. Where there are semicolons they separate, and a comma is the decimal sign.
std::vector<std::string_view> split(std::string_view line, std::string* buffer) {
  if (line.find(';') == std::string_view::npos) return split_fields(line, " \t,");
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
  for (int number = 1;; ++number) {
    const auto line = input->read_line();
    if (!line) break;
    std::string_view text = trimmed(*line);
    if (text.empty()) continue;
    const auto comment = comment_text(text);
    if (comment && !may_be_header) continue;
    const auto fields = split(comment.value_or(text), &buffer);
    if (const auto point = comment ? std::nullopt : parse_point(fields, columns)) {
      cloud->add(*point);
      ++num_points;
      may_be_header = false;
      continue;
    }
    if (may_be_header) {
      if (const auto named = named_columns(fields)) columns = *named;
      if (comment) continue;
      const auto count = fields.size() == 1 ? parse_int(fields[0]) : std::nullopt;
      if (count && *count >= 0) {  // PTS; "x y z" takes six bytes with the line end
        num_promised = static_cast<std::uint64_t>(*count);
        if (num_promised > input->remaining() / 6 + 1) break;
        continue;
      }
      const bool is_header = std::none_of(fields.begin(), fields.end(), [](std::string_view f) { return parse_double(f).has_value(); });
      if (is_header && fields.size() >= 3) {
        may_be_header = false;
        continue;
      }
    }
    return line_error(input->name(), number, "no point (x, y, z and what else there is): " + in_quotes(text));
  }
  if (num_promised > num_points) {
    return input->truncated("its first line promises " + std::to_string(num_promised) + " points, " + std::to_string(num_points) +
                            " are there");
  }
  return Status::ok();
}

}  // namespace camloc::mapping
