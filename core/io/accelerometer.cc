// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Line by line, then the unit of the whole file is told from the typical length: at rest a sensor measures one g.
#include "core/io/accelerometer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/io/file_bytes.h"
#include "core/io/text.h"

namespace camloc {
namespace {

constexpr double kMaxRelativeError = 0.2;  ///< of the typical length from one g
constexpr double kMaxReading = 1e6;

Result<AccelerometerSample> parse_line(const std::string& file_name, const TextLine& line) {
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() != 4) {
    return line_error(file_name, line.number, std::to_string(fields.size()) + " fields, expected 'timestamp ax ay az'");
  }
  AccelerometerSample sample;
  const std::optional<std::int64_t> stamp_ns = parse_seconds_ns(fields[0]);
  if (!stamp_ns) return line_error(file_name, line.number, "stamp " + in_quotes(fields[0]) + " is not a time in seconds");
  sample.stamp_ns = *stamp_ns;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> value = parse_double(fields[i + 1]);
    if (!value || !(std::abs(*value) <= kMaxReading)) {
      return line_error(file_name, line.number, in_quotes(fields[i + 1]) + " is not an acceleration");
    }
    sample.acceleration[static_cast<Eigen::Index>(i)] = *value;
  }
  return sample;
}

double median_length(const std::vector<AccelerometerSample>& samples) {
  std::vector<double> lengths;
  for (const AccelerometerSample& sample : samples) lengths.push_back(sample.acceleration.norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// To m/s^2.
Status fix_unit(const std::string& file_name, std::vector<AccelerometerSample>* samples) {
  const double length = median_length(*samples);
  if (std::abs(length / kStandardGravity - 1) <= kMaxRelativeError) return Status::ok();
  if (std::abs(length - 1) <= kMaxRelativeError) {
    for (AccelerometerSample& sample : *samples) sample.acceleration *= kStandardGravity;
    return Status::ok();
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", length);
  return {ErrorCode::kInvalid,
          file_name + ": readings have the typical length " + text + "; expected 9.8 (m/s^2) or 1 (g): convert the file"};
}

}  // namespace

Result<std::vector<AccelerometerSample>> read_accelerometer(const std::string& path) {
  const Result<std::string> text = read_file_text(path);
  if (!text) return text.status();
  std::vector<AccelerometerSample> samples;
  for (const TextLine& line : content_lines(*text)) {
    const Result<AccelerometerSample> sample = parse_line(path, line);
    if (!sample) return sample.status();
    if (!samples.empty() && sample->stamp_ns < samples.back().stamp_ns) {
      return line_error(path, line.number, "stamp is before the one above it; sort the file by time");
    }
    samples.push_back(*sample);
  }
  if (samples.empty()) return Status(ErrorCode::kInvalid, path + ": no reading in it");
  if (const Status status = fix_unit(path, &samples); !status) return status;
  return samples;
}

std::vector<OrientedReading> with_orientations(const std::vector<AccelerometerSample>& samples,
                                               const std::vector<StampedPose>& trajectory) {
  std::vector<OrientedReading> readings;
  for (const AccelerometerSample& sample : samples) {
    const std::optional<Rigid3> T_map_camera = pose_at(trajectory, sample.stamp_ns);
    if (T_map_camera) readings.push_back({T_map_camera->rotation, sample.acceleration});
  }
  return readings;
}

}  // namespace camloc
