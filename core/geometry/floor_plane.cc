// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Up from the floor: see gravity.h. Read gravity_from_floor() at the end first.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "core/base/order_statistics.h"
#include "core/geometry/gravity.h"

namespace camloc {
namespace {

constexpr double kCellM = 0.5;  ///< errors of points closer than this are one error
constexpr double kNearM = 0.3;
constexpr double kMinCellShare = 0.4;
constexpr std::uint32_t kMinCellPoints = 5;
constexpr double kMinSigmaRad = 0.003;  ///< floors are level to this
constexpr double kBelowM = 0.10;        ///< clearly below a plane
constexpr int kMaxLowerPlanes = 4;
constexpr double kMaxTiltRad = 0.61;  ///< 35 degrees between the floor's normal and the rough up
constexpr double kInlierDistanceM = 0.03;
constexpr double kMinHeightM = 0.25;          ///< of the cameras above the floor
constexpr double kMinInlierShare = 0.10;      ///< of the points that are below the cameras
constexpr double kMinSpreadM = 0.30;          ///< standard deviation of the floor in each direction
constexpr double kMinAreaM2 = 2;              ///< in cells that hold floor points and little just above or below
constexpr double kMinRelativeSupport = 0.25;  ///< a lower plane is the floor when it has this share of the points of a higher one
constexpr int kNumSamples = 3000;
constexpr std::size_t kMaxPoints = 60'000;  ///< taken evenly from all

using Points = std::vector<Eigen::Vector3d>;

/// Points p with normal . p = offset; the normal is a unit vector and points up.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;
  std::size_t num_inliers = 0;

  [[nodiscard]] double height(const Eigen::Vector3d& p) const { return normal.dot(p) - offset; }
};

double median_height(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& up) {
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : points) heights.push_back(up.dot(p));
  return upper_median(std::move(heights));
}

/// All of them, or `most` taken evenly.
Points evenly(const Points& points, std::size_t most) {
  Points some;
  const std::size_t count = std::min(points.size(), most);
  for (std::size_t i = 0; i < count; ++i) some.push_back(points[i * points.size() / count]);
  return some;
}

/// Finite points below the cameras, at most kMaxPoints of them.
Points points_below(std::span<const Eigen::Vector3d> points, double camera_height, const Eigen::Vector3d& up) {
  Points below;
  for (const Eigen::Vector3d& p : points) {
    if (p.allFinite() && up.dot(p) < camera_height - kMinHeightM) below.push_back(p);
  }
  return evenly(below, kMaxPoints);
}

std::size_t count_inliers(const Plane& plane, const Points& points) {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) { return std::abs(plane.height(p)) <= kInlierDistanceM; }));
}

/// The plane through three random points with most points on it; no inliers where none is level enough.
Plane sample_planes(const Points& points, const Eigen::Vector3d& up) {
  Plane best;
  if (points.size() < 3) return best;
  // Hypotheses are scored on some of the points, the best one on all.
  constexpr std::size_t kScoringPoints = 2000;
  const Points scoring = evenly(points, kScoringPoints);
  const double min_cosine = std::cos(kMaxTiltRad);
  std::mt19937 random(1);
  for (int i = 0; i < kNumSamples; ++i) {
    const Eigen::Vector3d &a = points[random() % points.size()], &b = points[random() % points.size()],
                          &c = points[random() % points.size()];
    Plane plane;
    plane.normal = (b - a).cross(c - a);
    const double length = plane.normal.norm();
    if (length < 1e-3) continue;  // closer together than the points are accurate
    plane.normal *= (plane.normal.dot(up) < 0 ? -1 : 1) / length;
    if (plane.normal.dot(up) < min_cosine) continue;
    plane.offset = plane.normal.dot(a);
    plane.num_inliers = count_inliers(plane, scoring);
    if (plane.num_inliers > best.num_inliers) best = plane;
  }
  if (best.num_inliers > 0) best.num_inliers = count_inliers(best, points);
  return best;
}

struct Fit {
  Plane plane;
  double rms_m = 0;
  double spread_m = 0;  ///< the smaller standard deviation of its cells within the plane
  double area_m2 = 0;   ///< of its cells
  double sigma_rad = 0;
};

/// What lies in one cell of a grid on the plane.
struct Cell {
  std::uint32_t num_on = 0;    ///< points on the plane
  std::uint32_t num_near = 0;  ///< and within a hand's breadth above or below
  [[nodiscard]] bool is_floor() const { return num_on >= kMinCellPoints && num_on >= kMinCellShare * num_near; }
};

/// A plane through clutter has points on it, too, but as many above and below. Looked up, never iterated.
class FloorGrid {
 public:
  FloorGrid(const Plane& plane, const Points& points) {
    const Eigen::Vector3d x = plane.normal.unitOrthogonal();
    axes_ << x.transpose(), plane.normal.cross(x).transpose();
    for (const Eigen::Vector3d& p : points) {
      const double height = std::abs(plane.height(p));
      if (height > kNearM) continue;
      Cell& cell = cells_[key(p)];
      ++cell.num_near;
      if (height <= kInlierDistanceM) ++cell.num_on;
    }
  }
  [[nodiscard]] bool is_floor_at(const Eigen::Vector3d& p) const {
    const auto found = cells_.find(key(p));
    return found != cells_.end() && found->second.is_floor();
  }
  [[nodiscard]] std::uint64_t key(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d cell = axes_ * p / kCellM;
    const auto index = [](double value) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value))) & 0xFFFFFFFF; };
    return index(cell.x()) << 32 | index(cell.y());
  }

 private:
  Eigen::Matrix<double, 2, 3> axes_;
  std::unordered_map<std::uint64_t, Cell> cells_;
};

/// Points on the plane where the plane is a floor.
Points floor_points(const Plane& plane, const Points& points, const FloorGrid& grid) {
  Points chosen;
  for (const Eigen::Vector3d& p : points) {
    if (std::abs(plane.height(p)) <= kInlierDistanceM && grid.is_floor_at(p)) chosen.push_back(p);
  }
  return chosen;
}

Eigen::Matrix3d scatter_of(const Points& points, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) scatter += (p - mean) * (p - mean).transpose();
  return scatter / static_cast<double>(points.size());
}

/// One point a cell: how far the floor reaches, whatever the density of the points.
Points thinned(const Points& points, const FloorGrid& grid) {
  std::unordered_set<std::uint64_t> taken;
  Points some;
  for (const Eigen::Vector3d& p : points) {
    if (taken.insert(grid.key(p)).second) some.push_back(p);
  }
  return some;
}

Eigen::Vector3d mean_of(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Least squares over the points of the floor, again with those near the new plane.
Fit refine(Plane plane, const Points& points) {
  Fit fit;
  for (int round = 0; round < 3; ++round) {
    const FloorGrid grid(plane, points);
    const Points inliers = floor_points(plane, points, grid);
    plane.num_inliers = inliers.size();
    if (inliers.size() < 3) break;
    const Eigen::Vector3d mean = mean_of(inliers);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter_of(inliers, mean));
    const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
    plane.normal = normal.dot(plane.normal) < 0 ? Eigen::Vector3d(-normal) : normal;
    plane.offset = plane.normal.dot(mean);
    fit.rms_m = std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
    const Points cells = thinned(inliers, grid);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of_cells(scatter_of(cells, mean_of(cells)));
    fit.spread_m = std::sqrt(std::max(0.0, of_cells.eigenvalues()[1]));
    fit.area_m2 = kCellM * kCellM * static_cast<double>(cells.size());
    const auto num_independent = static_cast<double>(std::max<std::size_t>(3, cells.size()));
    fit.sigma_rad = std::hypot(fit.rms_m / std::max(1e-3, fit.spread_m) / std::sqrt(num_independent), kMinSigmaRad);
  }
  fit.plane = plane;
  return fit;
}

/// A table is a plane, too, but there is one with much support below it.
Plane lowest_plane(const Points& points, const Eigen::Vector3d& up) {
  Plane plane = sample_planes(points, up);
  Points lower = points;
  for (int i = 0; i < kMaxLowerPlanes && plane.num_inliers > 0; ++i) {
    std::erase_if(lower, [&](const Eigen::Vector3d& p) { return plane.height(p) > -kBelowM; });
    const Plane candidate = sample_planes(lower, up);
    if (static_cast<double>(candidate.num_inliers) < kMinRelativeSupport * static_cast<double>(plane.num_inliers)) break;
    plane = candidate;
  }
  return plane;
}

std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

Status no_floor(const std::string& reason) {
  return {ErrorCode::kNotFound, "no clear floor: " + reason + "; let the camera see the floor, or give an accelerometer file"};
}

}  // namespace

Result<GravityEstimate> gravity_from_floor(std::span<const Eigen::Vector3d> points_map, std::span<const Eigen::Vector3d> camera_centers_map,
                                           const Eigen::Vector3d& rough_up_map) {
  if (camera_centers_map.empty()) return {ErrorCode::kInvalid, "no camera to look for a floor below"};
  const Eigen::Vector3d up = rough_up_map.normalized();
  const Points points = points_below(points_map, median_height(camera_centers_map, up), up);
  if (points.size() < 3) return no_floor("no points below the cameras");
  const Fit fit = refine(lowest_plane(points, up), points);

  GravityEstimate estimate;
  estimate.source = GravitySource::kFloor;
  estimate.up_map = fit.plane.normal;
  estimate.sigma_rad = fit.sigma_rad;
  estimate.inlier_share = static_cast<double>(fit.plane.num_inliers) / static_cast<double>(points.size());
  estimate.camera_height_m = median_height(camera_centers_map, fit.plane.normal) - fit.plane.offset;
  if (estimate.inlier_share < kMinInlierShare) {
    return no_floor("the best level plane holds only " + percent(estimate.inlier_share) + " of the points below the cameras");
  }
  if (fit.spread_m < kMinSpreadM || fit.area_m2 < kMinAreaM2) return no_floor("the best level plane is only a strip or a small patch");
  if (fit.plane.normal.dot(up) < std::cos(kMaxTiltRad)) return no_floor("the best plane is not level");
  if (estimate.camera_height_m < kMinHeightM) return no_floor("the best level plane is not below the cameras");
  const auto num_below = static_cast<double>(
      std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) { return fit.plane.height(p) < -kBelowM; }));
  if (num_below > 0.5 * static_cast<double>(fit.plane.num_inliers)) return no_floor("many points lie below the best level plane");
  return estimate;
}

}  // namespace camloc
