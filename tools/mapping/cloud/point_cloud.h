// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A cloud of surface points, thinned to one point a voxel while it is read, so that a scan of any size fits into memory.
// Read from files (cloud_file.cc): PLY, PCD, LAS, PTX, and text tables (XYZ, PTS, CSV). The kind is told from the content, the name only
// decides where the content does not say.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/base/result.h"
#include "core/base/work_observer.h"

namespace camloc::mapping {

/// Points relative to an origin: survey coordinates have seven digits before the point, a float holds seven in all.
struct PointCloud {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< p_cloud = origin_m + points_m[i]
  std::vector<Eigen::Vector3f> points_m;
  std::uint64_t num_read = 0;         ///< with the invalid ones
  std::uint64_t num_invalid = 0;      ///< not finite, marked as withheld, or absurdly far from the others
  double unit_m = 1;                  ///< metres per unit of the file, as it was read
  std::string unit_from;              ///< who says so, for people
  std::vector<std::string> notes;     ///< how the file was understood where it leaves a choice
  std::vector<std::string> warnings;  ///< what speaks against that
  /// Per axis the smallest difference that the numbers of the file can hold, as far as it shows; 0 where it is fine.
  Eigen::Vector3d step_m = Eigen::Vector3d::Zero();

  /// 0.5th and 99.5th percentile along each axis, relative to the origin: a stray return must not decide.
  [[nodiscard]] std::array<Eigen::Vector3d, 2> bounds_m() const;
};

struct CloudOptions {
  double voxel_m = 0.01;         ///< edge of the voxels; a point of a voxel is the mean of what fell into it
  std::optional<double> unit_m;  ///< metres per unit of what is added; nothing: what the file says, or metres
  std::uint32_t min_points = 1;  ///< voxels with fewer points are dropped
};

/// Takes points one by one. Memory: about twice what is kept, plus a few tens of megabytes. The same points in the same order
/// give the same bits.
class CloudAccumulator {
 public:
  explicit CloudAccumulator(const CloudOptions& options);
  /// In units of the file. Not finite ones are counted as invalid.
  void add(const Eigen::Vector3d& p);
  void add_invalid() { ++cloud_.num_read, ++cloud_.num_invalid; }
  /// The file says its unit; `source` is "US survey feet (GeoKey 3076)". Before the first point. A unit that the options give goes before.
  void declare_unit(double unit_m, const std::string& source);
  /// False where the options give a unit, which then is that of all axes.
  [[nodiscard]] bool takes_declared_unit() const { return !options_.unit_m; }
  void note(std::string text) { cloud_.notes.push_back(std::move(text)); }
  void warn(std::string text) { cloud_.warnings.push_back(std::move(text)); }
  /// The cloud; the accumulator is empty then.
  [[nodiscard]] PointCloud finish();

 private:
  struct Voxel {
    std::array<std::int32_t, 3> cell;
    std::uint32_t count;
    Eigen::Vector3f sum_m;  ///< of positions relative to the cell's lower corner
  };

  void start();
  /// Of 32-bit floats at the place of the cloud, on axes where no number says more than such a float.
  [[nodiscard]] Eigen::Vector3d float_steps_m() const;
  void store(const Eigen::Vector3d& p_m);
  void compact();

  CloudOptions options_;
  PointCloud cloud_;
  std::vector<Eigen::Vector3d> first_points_m_;  ///< until the origin is chosen
  bool is_started_ = false;
  std::array<bool, 3> exceeds_float_{};  ///< a coordinate of this axis was no 32-bit float
  std::vector<Voxel> voxels_;            ///< [0, num_compact_) sorted, one a cell; then as they came
  std::size_t num_compact_ = 0;
  std::size_t compact_at_ = 0;
};

/// A point a voxel of `cell_m`.
template <typename Points>
[[nodiscard]] PointCloud thinned(const Points& points_m, double cell_m) {
  CloudAccumulator accumulator({cell_m, {}, 1});
  for (const auto& p : points_m) accumulator.add(p.template cast<double>());
  return accumulator.finish();
}

/// The corners of a box around `points`, every `step`-th of which is asked, without one part in `parts` at each end of each axis.
template <typename Points>
[[nodiscard]] std::array<Eigen::Vector3d, 2> trimmed_bounds(const Points& points, std::size_t parts, std::size_t step = 1) {
  std::array<Eigen::Vector3d, 2> bounds{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (std::size_t i = 0; i < points.size(); i += step) values.push_back(static_cast<float>(points[i][axis]));
    std::tie(bounds[0][axis], bounds[1][axis]) = trimmed_range(std::move(values), parts);
  }
  return bounds;
}

/// At most `max_points`, evenly by their order.
[[nodiscard]] std::vector<Eigen::Vector3d> chosen_evenly(std::span<const Eigen::Vector3d> points, std::size_t max_points);
/// As single floats.
[[nodiscard]] std::vector<Eigen::Vector3f> to_float(std::span<const Eigen::Vector3d> points);

/// Errors, all naming the file: kNotFound, kIo (unreadable, or stopped by `observer`), kUnsupported (LAZ, E57, an unknown kind, a
/// variant that is not read; says how to convert), kCorrupt (truncated, counts larger than the file, a line that is no
/// point), kInvalid (no points, none of them finite; coordinates in steps of more than a centimetre, or in degrees).
[[nodiscard]] Result<PointCloud> read_cloud(const std::string& path, const CloudOptions& options,
                                            WorkObserver& observer = WorkObserver::nobody());

/// The same from a stream; `name` also gives the extension.
[[nodiscard]] Result<PointCloud> read_cloud(std::istream& stream, const std::string& name, const CloudOptions& options,
                                            WorkObserver& observer = WorkObserver::nobody());

}  // namespace camloc::mapping
