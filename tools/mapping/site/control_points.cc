// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The two text files: rows, columns, and what is wrong with them.
#include "tools/mapping/site/control_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/io/file_bytes.h"
#include "core/io/text.h"
#include "tools/mapping/site/table_row.h"

namespace camloc::mapping {
namespace {

constexpr double kMaxCoordinateM = 1e8;
constexpr double kMaxSigma = 100;
constexpr std::size_t kMaxNameBytes = 63;
constexpr std::size_t kMaxLines = 10'000;
constexpr std::size_t kMaxFileBytes = std::size_t{16} << 20;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

/// One line of a file. What is wrong first is kept, with file, line and field; what is read after that means nothing.
class RowReader {
 public:
  RowReader(const std::string& file_name, int line, const Row& row) : file_name_(file_name), line_(line), row_(row) {}

  [[nodiscard]] const Status& status() const { return status_; }
  void fail(const std::string& what) {
    if (status_.is_ok()) status_ = line_error(file_name_, line_, what);
  }

  double number(std::size_t field, double low, double high, const std::string& what) {
    const std::optional<double> value = parse_double(row_[field]);
    if (!value || !std::isfinite(*value)) {
      fail(what + " " + in_quotes(row_[field]) + " is not a number (decimal point, no unit)");
    } else if (*value < low || *value > high) {
      fail(what + " " + in_quotes(row_[field]) + " is out of range");
    }
    return value.value_or(0);
  }

  /// Fit for tables and messages.
  std::string name(std::string_view name) {
    const bool is_printable = std::none_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; });
    if (name.empty()) fail("no name");
    if (!is_printable || name.size() > kMaxNameBytes) fail("name " + in_quotes(name) + " is too long or has control characters");
    return std::string(name);
  }

  Eigen::Vector3d position(const std::array<std::size_t, 3>& fields) {
    const auto coordinate = [&](std::size_t axis, const char* what) {
      return number(fields[axis], -kMaxCoordinateM, kMaxCoordinateM, what);
    };
    return {coordinate(0, "x"), coordinate(1, "y"), coordinate(2, "z")};  // in this order
  }

  /// The field when it is there, else `fallback`.
  double sigma(std::size_t field, double fallback) {
    if (field >= row_.size()) return fallback;
    const double value = number(field, 0, kMaxSigma, "sigma");
    if (value < 1e-6) fail("sigma must be positive");
    return value;
  }

  std::uint32_t index(std::size_t field, const std::string& what) {
    const std::optional<std::int64_t> value = parse_int(row_[field]);
    const bool is_index = value && *value >= 0 && *value <= std::numeric_limits<std::int32_t>::max();
    if (!is_index) fail(what + " " + in_quotes(row_[field]) + " is not a number from 0 on");
    return is_index ? static_cast<std::uint32_t>(*value) : 0;
  }

 private:
  const std::string& file_name_;
  int line_;
  const Row& row_;
  Status status_;
};

/// Which field of a row is the name, x, y, z and sigma.
using Columns = std::array<std::size_t, 5>;

/// Index of a column title in Columns; nullopt for any other word.
std::optional<std::size_t> column_of(std::string_view title) {
  static const std::map<std::string, std::size_t, std::less<>> kTitles = {
      {"name", 0},   {"id", 0},        {"point", 0}, {"point_id", 0}, {"nr", 0},    {"no", 0},       {"x", 1}, {"e", 1},
      {"east", 1},   {"easting", 1},   {"y", 2},     {"n", 2},        {"north", 2}, {"northing", 2}, {"z", 3}, {"h", 3},
      {"height", 3}, {"elevation", 3}, {"up", 3},    {"u", 3},        {"sigma", 4}, {"sigma_m", 4}};
  const auto found = kTitles.find(lower_case(title));
  return found == kTitles.end() ? std::nullopt : std::optional(found->second);
}

/// The columns that a line of titles names; nullopt where the line is no such line.
std::optional<Columns> columns_of_titles(const Row& row) {
  std::array<std::optional<std::size_t>, 5> field_of{};
  for (std::size_t field = 0; field < row.size(); ++field) {
    const std::optional<std::size_t> column = column_of(row[field]);
    if (column && !field_of[*column]) field_of[*column] = field;
  }
  for (std::size_t column = 0; column < 4; ++column) {
    if (!field_of[column]) return std::nullopt;
  }
  return Columns{*field_of[0], *field_of[1], *field_of[2], *field_of[3], field_of[4].value_or(row.size())};
}

Result<ControlPoint> parse_point(RowReader reader, const Row& row, const Columns& columns, int line) {
  const auto& [name, x, y, z, sigma] = columns;
  const std::size_t last = std::max({name, x, y, z});
  if (row.size() <= last) {
    reader.fail(std::to_string(row.size()) + (row.size() == 1 ? " field" : " fields") + ", expected 'name x y z [sigma_m]'");
    return reader.status();
  }
  ControlPoint point;
  point.p_wcs = reader.position({x, y, z});
  point.sigma_m = reader.sigma(sigma, kDefaultPointSigmaM);
  point.name = reader.name(row[name]);
  point.line = line;
  if (!reader.status()) return reader.status();
  return point;
}

Result<ControlObservation> parse_observation(RowReader reader, const Row& row, int line) {
  ControlObservation observation;
  observation.name = reader.name(row.empty() ? std::string_view() : row[0]);
  observation.line = line;
  if (!reader.status()) return reader.status();
  const std::string kind = row.size() > 1 ? lower_case(row[1]) : "";
  const auto has_fields = [&](std::size_t num_fields, const char* form) {
    const bool has = row.size() == num_fields || row.size() == num_fields + 1;
    if (!has) reader.fail(std::to_string(row.size()) + " fields, expected '" + form + "'");
    return has;
  };
  if (kind == "map") {
    if (!has_fields(5, "name map x y z [sigma_m]")) return reader.status();
    observation.p_map = reader.position({2, 3, 4});
    observation.sigma = reader.sigma(5, kDefaultPickedSigmaM);
  } else if (kind == "landmark") {
    observation.kind = ObservationKind::kLandmark;
    if (!has_fields(3, "name landmark INDEX [sigma_m]")) return reader.status();
    observation.landmark = reader.index(2, "landmark");
    observation.sigma = reader.sigma(3, 0);
  } else if (kind == "pixel") {
    observation.kind = ObservationKind::kPixel;
    if (!has_fields(5, "name pixel FRAME u v [sigma_px]")) return reader.status();
    observation.frame = reader.index(2, "frame");
    observation.u = reader.number(3, -0.5, 65535, "u");
    observation.v = reader.number(4, -0.5, 65535, "v");
    observation.sigma = reader.sigma(5, kDefaultPixelSigmaPx);
  } else {
    reader.fail(in_quotes(row.size() > 1 ? row[1] : "") + " is not 'map', 'landmark' or 'pixel'");
  }
  if (!reader.status()) return reader.status();
  return observation;
}

Status check_number_of_lines(std::size_t num_lines, const std::string& file_name, const char* what) {
  if (num_lines == 0) return {ErrorCode::kInvalid, file_name + ": no " + what + " in it"};
  if (num_lines <= kMaxLines) return Status::ok();
  return {ErrorCode::kInvalid, file_name + ": " + std::to_string(num_lines) + " lines; is it really a file of control points?"};
}

}  // namespace

Result<std::vector<ControlPoint>> parse_control_points(std::string_view text, const std::string& file_name) {
  const std::vector<TextLine> lines = content_lines(text);
  if (const Status status = check_number_of_lines(lines.size(), file_name, "control point"); !status) return status;
  std::vector<ControlPoint> points;
  std::map<std::string, int> line_of_name;
  Columns columns = {0, 1, 2, 3, 4};
  std::string buffer;
  for (const TextLine& line : lines) {
    const Row row = split_row(line.text, 4, &buffer);
    if (&line == &lines.front()) {
      if (const std::optional<Columns> titles = columns_of_titles(row)) {
        columns = *titles;
        continue;
      }
    }
    if (row.size() > 4 && has_split_name(line.text, row)) return line_error(file_name, line.number, kSplitNameAdvice);
    const Result<ControlPoint> point = parse_point(RowReader(file_name, line.number, row), row, columns, line.number);
    if (!point) return point.status();
    const auto [known, is_new] = line_of_name.emplace(point->name, line.number);
    if (!is_new) {
      return line_error(file_name, line.number,
                        "point " + in_quotes(point->name) + " is already in line " + std::to_string(known->second) +
                            "; give each point a name of its own");
    }
    points.push_back(*point);
  }
  if (points.empty()) return Status(ErrorCode::kInvalid, file_name + ": no control point in it");
  return points;
}

Result<std::vector<ControlObservation>> parse_control_observations(std::string_view text, const std::string& file_name) {
  const std::vector<TextLine> lines = content_lines(text);
  if (const Status status = check_number_of_lines(lines.size(), file_name, "observation"); !status) return status;
  std::vector<ControlObservation> observations;
  std::string buffer;
  for (const TextLine& line : lines) {
    const Row row = split_row(line.text, 3, &buffer);
    const Result<ControlObservation> observation = parse_observation(RowReader(file_name, line.number, row), row, line.number);
    if (!observation) return observation.status();
    observations.push_back(*observation);
  }
  return observations;
}

Result<std::vector<ControlPoint>> read_control_points(const std::string& path) {
  const Result<std::string> text = read_file_text(path, kMaxFileBytes);
  return text ? parse_control_points(*text, path) : Result<std::vector<ControlPoint>>(text.status());
}

Result<std::vector<ControlObservation>> read_control_observations(const std::string& path) {
  const Result<std::string> text = read_file_text(path, kMaxFileBytes);
  return text ? parse_control_observations(*text, path) : Result<std::vector<ControlObservation>>(text.status());
}

}  // namespace camloc::mapping
