// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/io/file_bytes.h"
#include "core/io/text.h"
#include "tools/mapping/site/control_points.h"
#include "tools/mapping/site/table_row.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{16} << 20;
constexpr std::size_t kMinFields = 7;

}  // namespace

Result<std::vector<ControlPair>> parse_point_pairs(std::string_view text, const std::string& path) {
  std::vector<ControlPair> pairs;
  std::string buffer;
  const std::vector<TextLine> lines = content_lines(text);
  const int first_line = lines.empty() ? 0 : lines.front().number;
  for (const TextLine& line : lines) {
    const Row fields = split_row(line.text, kMinFields, &buffer);
    const bool has_numbers =
        std::any_of(fields.begin(), fields.end(), [](std::string_view field) { return parse_double(field).has_value(); });
    if (line.number == first_line && !has_numbers) continue;  // titles
    if (fields.size() > kMinFields && has_split_name(line.text, fields)) return line_error(path, line.number, kSplitNameAdvice);
    if (fields.size() != kMinFields && fields.size() != kMinFields + 1) {
      return line_error(path, line.number,
                        "has " + std::to_string(fields.size()) + (fields.size() == 1 ? " field" : " fields") +
                            "; 'name map_x map_y map_z cloud_x cloud_y cloud_z [sigma]' has 7 or 8");
    }
    ControlPair pair;
    pair.name = std::string(fields[0]);
    double numbers[7] = {0, 0, 0, 0, 0, 0, pair.sigma_m};
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const auto value = parse_double(fields[i]);
      if (!value || !std::isfinite(*value)) return line_error(path, line.number, in_quotes(fields[i]) + " is no number");
      numbers[i - 1] = *value;
    }
    pair.p_map = {numbers[0], numbers[1], numbers[2]};
    pair.p_cloud = {numbers[3], numbers[4], numbers[5]};
    pair.sigma_m = numbers[6];
    if (!(pair.sigma_m > 0)) return line_error(path, line.number, "sigma must be positive, in metres");
    const auto same = [&](const ControlPair& other) { return other.name == pair.name; };
    if (std::any_of(pairs.begin(), pairs.end(), same))
      return line_error(path, line.number, "point " + in_quotes(pair.name) + " was given before");
    pairs.push_back(std::move(pair));
  }
  if (pairs.size() < 3)
    return {ErrorCode::kInvalid, path + ": has " + std::to_string(pairs.size()) + " control points; at least 3 are needed"};
  return pairs;
}

Result<std::vector<ControlPair>> read_point_pairs(const std::string& path) {
  const auto text = read_file_text(path, kMaxFileBytes);
  if (!text.is_ok()) return text.status();
  return parse_point_pairs(text.value(), path);
}

}  // namespace camloc::mapping
