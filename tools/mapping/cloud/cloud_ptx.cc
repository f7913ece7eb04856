// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Leica's PTX: per scan the number of columns and of rows, the scanner's position and its three axes, a 4x4 matrix for row vectors
// (p_site = p * M), then columns * rows points in the scanner's own frame. The matrix alone is believed; the four lines before it
// say the same again in most files and nothing in some.
#include <cmath>
#include <string>
#include <vector>

#include "core/base/checked.h"
#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr double kMaxShear = 1e-3;  // of M M^T - I; files carry six digits

std::optional<std::uint64_t> whole_number(std::string_view line) {
  const auto value = parse_int(trimmed(line));
  return value && *value >= 0 ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

/// The next line that is not empty.
std::optional<std::string_view> next_line(CloudInput* input, int* number) {
  while (const auto line = input->read_line()) {
    ++*number;
    if (const std::string_view text = trimmed(*line); !text.empty()) return text;
  }
  return std::nullopt;
}

/// Exactly as many finite numbers as `values` has room for.
bool parse_numbers(std::string_view line, std::span<double> values) {
  const auto fields = split_fields(line, " \t");
  if (fields.size() != values.size()) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = parse_double(fields[i]).value_or(std::nan(""));
    if (!std::isfinite(values[i])) return false;
  }
  return true;
}

struct Scan {
  std::uint64_t num_points = 0;
  Eigen::Matrix3d axes;  ///< of M; p_site^T = p^T * axes + position^T
  Eigen::Vector3d position;
};

/// `columns` is the first line of the scan.
Result<Scan> read_scan_header(CloudInput* input, std::string_view columns, int* number) {
  const auto bad = [&](const char* what) { return line_error(input->name(), *number, std::string("no PTX header: ") + what); };
  const auto num_columns = whole_number(columns);
  if (!num_columns) return bad("the number of columns is missing (does the scan before have more points than its header says?)");
  const auto rows = next_line(input, number);
  const auto num_rows = rows ? whole_number(*rows) : std::nullopt;
  const auto num_points = num_rows ? checked_multiply(*num_columns, *num_rows) : std::nullopt;
  if (!num_points) return bad("the number of rows is missing");
  for (int i = 0; i < 4; ++i) {
    double ignored[3];
    const auto line = next_line(input, number);
    if (!line || !parse_numbers(*line, ignored)) return bad("the scanner's position and axes are four lines of three numbers");
  }
  Scan scan;
  scan.num_points = *num_points;
  for (int i = 0; i < 4; ++i) {
    double v[4];
    const auto line = next_line(input, number);
    if (!line || !parse_numbers(*line, v)) return bad("the matrix is four lines of four numbers");
    if (i < 3) scan.axes.row(i) << v[0], v[1], v[2];
    if (i == 3) scan.position << v[0], v[1], v[2];
  }
  if (!((scan.axes * scan.axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxShear)) {
    return bad("the matrix is no rotation with a translation in its last row");
  }
  if (scan.num_points > input->remaining() / 6 + 1) {  // "0 0 0" and a line end
    return input->truncated("a scan promises " + std::to_string(scan.num_points) + " points, " + std::to_string(input->remaining()) +
                            " bytes are left");
  }
  return scan;
}

Status read_scan(CloudInput* input, const Scan& scan, int* number, CloudAccumulator* cloud) {
  for (std::uint64_t i = 0; i < scan.num_points; ++i) {
    const auto line = next_line(input, number);
    if (!line) {
      return input->truncated("a scan promises " + std::to_string(scan.num_points) + " points, " + std::to_string(i) + " are there");
    }
    const auto p = parse_point(split_fields(*line, " \t"), {0, 1, 2});
    if (!p) return line_error(input->name(), *number, "no point (x, y, z and what else there is): " + in_quotes(*line));
    if (p->isZero(0)) {
      cloud->add_invalid();
    } else {
      cloud->add(scan.axes.transpose() * *p + scan.position);
    }
  }
  return Status::ok();
}

}  // namespace

bool is_ptx(std::string_view start) {
  double position[3];
  std::vector<std::string_view> lines;
  while (lines.size() < 3 && !start.empty()) {
    const std::size_t end = start.find_first_of("\r\n");
    if (end == std::string_view::npos) break;
    if (const std::string_view line = trimmed(start.substr(0, end)); !line.empty()) lines.push_back(line);
    start.remove_prefix(end + 1);
  }
  return lines.size() == 3 && whole_number(lines[0]) && whole_number(lines[1]) && parse_numbers(lines[2], position);
}

Status read_ptx(CloudInput* input, CloudAccumulator* cloud) {
  int number = 0, num_scans = 0;
  while (const auto line = next_line(input, &number)) {
    const auto scan = read_scan_header(input, *line, &number);
    if (!scan.is_ok()) return scan.status();
    if (const Status read = read_scan(input, scan.value(), &number, cloud); !read.is_ok()) return read;
    ++num_scans;
  }
  cloud->note("PTX of " + std::to_string(num_scans) + (num_scans == 1 ? " scan" : " scans, each") +
              " placed by its matrix; rays without return are invalid");
  return Status::ok();
}

}  // namespace camloc::mapping
