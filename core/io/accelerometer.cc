// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Line by line, then the unit of the whole file is told from the typical length: at rest a sensor measures one g.
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/io/file_bytes.h"
#include "core/io/sequence.h"
#include "core/io/text.h"

namespace camloc {
namespace {

constexpr double kMaxRelativeError = 0.2;  ///< of the typical length from one g
constexpr double kMaxReading = 1e6;

/// To m/s^2.
Status fix_unit(const std::string& file_name, std::vector<AccelerometerSample>* samples) {
  std::vector<double> lengths;
  for (const AccelerometerSample& sample : *samples) lengths.push_back(sample.acceleration.norm());
  const double length = upper_median(lengths);
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
  const auto add = [&samples](std::int64_t stamp_ns, std::span<const double> v) {
    samples.push_back({stamp_ns, {v[0], v[1], v[2]}});
    return Status::ok();
  };
  if (Status status = read_stamped_rows(*text, path, "timestamp ax ay az", "an acceleration", kMaxReading, add); !status) return status;
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
