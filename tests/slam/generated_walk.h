// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Generated truth for SLAM: rooms whose walls are covered with points that have descriptors, and the views a camera would have
// of them. No images are needed, so a walk of hundreds of views takes a moment.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/geometry/alignment.h"
#include "core/registration/frame_features.h"
#include "core/slam/slam.h"

namespace camloc::testing {

struct WorldPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitX();
  double reference_m = 3;  ///< distance at which it is a corner of level 0
  Descriptor descriptor;
};

/// x, y of an upright block that hides what is behind it.
struct WorldBlock {
  Eigen::Vector2d low_m, high_m;
};

struct World {
  std::vector<WorldPoint> points;
  std::vector<WorldBlock> blocks;
};

inline Descriptor random_descriptor(std::mt19937_64& rng) { return {{rng(), rng(), rng(), rng()}}; }

/// Points on a rectangle, with a relief of a few centimetres towards the normal.
inline void add_wall(std::mt19937_64& rng, const Eigen::Vector3d& corner, const Eigen::Vector3d& side_a, const Eigen::Vector3d& side_b,
                     double points_per_m2, World* world) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::Vector3d normal = side_a.cross(side_b).normalized();
  const auto count = static_cast<int>(points_per_m2 * side_a.cross(side_b).norm());
  for (int i = 0; i < count; ++i) {
    WorldPoint point;
    const double a = uniform(rng), b = uniform(rng), relief = 0.15 * uniform(rng);
    point.position_m = corner + a * side_a + b * side_b + relief * normal;
    point.normal = normal;
    point.reference_m = 1.5 * std::pow(6.0, uniform(rng));
    point.descriptor = random_descriptor(rng);
    world->points.push_back(point);
  }
}

/// Four walls, floor and ceiling, seen from inside; `low` and `high` are opposite corners.
inline void add_room(std::mt19937_64& rng, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double points_per_m2, World* world) {
  const Eigen::Vector3d x(high.x() - low.x(), 0, 0), y(0, high.y() - low.y(), 0), z(0, 0, high.z() - low.z());
  add_wall(rng, low, y, z, points_per_m2, world);
  add_wall(rng, low, z, x, points_per_m2, world);
  add_wall(rng, high, -z, -y, points_per_m2, world);
  add_wall(rng, high, -x, -z, points_per_m2, world);
  add_wall(rng, low, x, y, 0.3 * points_per_m2, world);
  add_wall(rng, high, -y, -x, 0.3 * points_per_m2, world);
}

inline World make_room(std::uint64_t seed = 1, double points_per_m2 = 60) {
  std::mt19937_64 rng(seed);
  World world;
  add_room(rng, {-3, -2.5, 0}, {3, 2.5, 2.8}, points_per_m2, &world);
  return world;
}

/// A corridor of 2 m around a block; the middle of the corridor is a square of `side_m`, from (0, 0) to (side_m, side_m).
inline World make_ring(std::uint64_t seed, double side_m, double points_per_m2 = 80) {
  std::mt19937_64 rng(seed);
  World world;
  add_room(rng, {-1, -1, 0}, {side_m + 1, side_m + 1, 2.5}, points_per_m2, &world);
  const double low = 1, size = side_m - 2;
  const Eigen::Vector3d z(0, 0, 2.5);
  add_wall(rng, {low, low, 0}, Eigen::Vector3d(size, 0, 0), z, points_per_m2, &world);
  add_wall(rng, {low + size, low, 0}, Eigen::Vector3d(0, size, 0), z, points_per_m2, &world);
  add_wall(rng, {low + size, low + size, 0}, Eigen::Vector3d(-size, 0, 0), z, points_per_m2, &world);
  add_wall(rng, {low, low + size, 0}, Eigen::Vector3d(0, -size, 0), z, points_per_m2, &world);
  world.blocks.push_back({{low, low}, {low + size, low + size}});
  return world;
}

/// A camera at a point, looking along the heading, a little down for a negative pitch.
inline Rigid3 looking(const Eigen::Vector3d& position_m, double yaw_rad, double pitch_rad = 0) {
  const Eigen::Vector3d forward(std::cos(yaw_rad) * std::cos(pitch_rad), std::sin(yaw_rad) * std::cos(pitch_rad), std::sin(pitch_rad));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << right, forward.cross(right), forward;
  return {Eigen::Quaterniond(R), position_m};
}

struct ViewerOptions {
  double noise_px = 0.4;           ///< of level 0; a little more on higher ones
  double seen_share = 0.85;        ///< of the points in view
  double depth_noise_share = 0.5;  ///< of the camera's sigma
  double hole_share = 0.1;         ///< features without depth
  double depth_outlier_share = 0, descriptor_outlier_share = 0;
  int flipped_bits = 14;
  std::size_t max_features = 600;
  double rate_hz = 10;
};

/// What a camera sees of a world. The same seed gives the same views.
class Viewer {
 public:
  Viewer(const World& world, const ViewerOptions& options = {}, std::uint64_t seed = 5) : world_(world), options_(options), rng_(seed) {
    camera_.name = "generated";
    camera_.color.width = 640;
    camera_.color.height = 480;
    camera_.color.fx = camera_.color.fy = 525;
    camera_.color.cx = 319.5;
    camera_.color.cy = 239.5;
    camera_.depth = camera_.color;
    camera_.max_depth_m = 4.5;
    camera_.depth_noise = {0.001, 0.002};
  }

  [[nodiscard]] const RgbdCamera& camera() const { return camera_; }
  [[nodiscard]] ViewerOptions& options() { return options_; }
  /// The points that the features of the last view show.
  [[nodiscard]] const std::vector<std::uint32_t>& shown() const { return shown_; }

  [[nodiscard]] FrameFeatures blank(std::uint64_t frame) const {
    FrameFeatures view;
    view.stamp_ns = stamp_ns(frame);
    return view;
  }

  /// The pose of the result is not set: it is what SLAM has to find.
  FrameFeatures see(std::uint64_t frame, const Rigid3& T_world_camera) {
    FrameFeatures view = blank(frame);
    shown_.clear();
    const Rigid3 T_camera_world = T_world_camera.inverse();
    for (std::uint32_t i = 0; i < world_.points.size(); ++i) {
      const Eigen::Vector3d p = T_camera_world * world_.points[i].position_m;
      if (p.z() < 0.3 || p.z() > 25 || !is_visible(world_.points[i], T_world_camera.translation)) continue;
      add_feature(i, p, T_camera_world, &view);
    }
    keep_some(&view);
    return view;
  }

 private:
  [[nodiscard]] std::int64_t stamp_ns(std::uint64_t frame) const {
    return 1'000'000'000 + static_cast<std::int64_t>(1e9 * static_cast<double>(frame) / options_.rate_hz);
  }

  [[nodiscard]] bool is_visible(const WorldPoint& point, const Eigen::Vector3d& from) const {
    const Eigen::Vector3d to = from - point.position_m;
    if (to.dot(point.normal) < 0.3 * to.norm()) return false;
    return std::none_of(world_.blocks.begin(), world_.blocks.end(), [&](const WorldBlock& block) {
      double begin = 0, end = 1;  // of the stretch of the line of sight inside the block
      for (int axis = 0; axis < 2; ++axis) {
        const double start = from[axis], step = point.position_m[axis] - from[axis];
        if (std::abs(step) < 1e-9) {
          if (start < block.low_m[axis] || start > block.high_m[axis]) return false;
          continue;
        }
        const double a = (block.low_m[axis] - start) / step, b = (block.high_m[axis] - start) / step;
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
      }
      return end - begin > 1e-6 && begin < 1 - 1e-6;
    });
  }

  void add_feature(std::uint32_t index, const Eigen::Vector3d& p, const Rigid3& T_camera_world, FrameFeatures* view) {
    const WorldPoint& point = world_.points[index];
    const double level = std::log(point.reference_m / p.norm()) / std::log(1.2);
    if (level < -1.5 || level > 8.5 || chance() >= options_.seen_share) return;
    Keypoint keypoint;
    keypoint.level = static_cast<std::uint8_t>(std::clamp(static_cast<int>(std::lround(level)), 0, 7));
    const double sigma = options_.noise_px * (1 + 0.3 * (std::pow(1.2, keypoint.level) - 1));
    const Eigen::Vector2d pixel = camera_.color.project(p) + sigma * Eigen::Vector2d(normal_(rng_), normal_(rng_));
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > camera_.color.width - 1 || pixel.y() > camera_.color.height - 1) return;
    keypoint.u = static_cast<float>(pixel.x());
    keypoint.v = static_cast<float>(pixel.y());
    const Eigen::Vector3d along = T_camera_world.rotation * point.normal.cross(Eigen::Vector3d(0.3, 0.5, 0.8)).normalized();
    const Eigen::Vector3d q = p + 0.01 * along;
    const double angle = std::atan2(q.y() / q.z() - p.y() / p.z(), q.x() / q.z() - p.x() / p.z());
    keypoint.angle_rad = static_cast<float>(angle < 0 ? angle + 2 * std::numbers::pi : angle);
    const bool is_other = chance() < options_.descriptor_outlier_share;
    view->features.keypoints.push_back(keypoint);
    view->features.descriptors.push_back(seen_descriptor(is_other ? world_.points[rng_() % world_.points.size()] : point));
    view->normalized.push_back(camera_.color.undistort({keypoint.u, keypoint.v}).cast<float>());
    view->depth_m.push_back(seen_depth(p.z()));
    shown_.push_back(index);
  }

  Descriptor seen_descriptor(const WorldPoint& point) {
    Descriptor descriptor = point.descriptor;
    for (int i = 0; i < options_.flipped_bits; ++i) {
      const std::uint64_t bit = rng_() % 256;
      descriptor.bits[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
    return descriptor;
  }

  float seen_depth(double z) {
    const double noisy = z + options_.depth_noise_share * camera_.depth_noise.sigma_m(z) * normal_(rng_);
    const bool is_hole = chance() < options_.hole_share, is_outlier = chance() < options_.depth_outlier_share;
    if (is_hole || noisy < camera_.min_depth_m || noisy > camera_.max_depth_m) return 0;
    return static_cast<float>(is_outlier ? noisy * (0.6 + 0.8 * chance()) : noisy);
  }

  // The first of a shuffled order: an even choice.
  void keep_some(FrameFeatures* view) {
    std::vector<std::size_t> order(view->size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng_() % i]);
    order.resize(std::min(order.size(), options_.max_features));
    FrameFeatures kept = FrameFeatures{view->T_map_camera, view->stamp_ns, {}, {}, {}, {}};
    std::vector<std::uint32_t> shown;
    for (const std::size_t i : order) {
      kept.features.keypoints.push_back(view->features.keypoints[i]);
      kept.features.descriptors.push_back(view->features.descriptors[i]);
      kept.normalized.push_back(view->normalized[i]);
      kept.depth_m.push_back(view->depth_m[i]);
      shown.push_back(shown_[i]);
    }
    *view = std::move(kept);
    shown_ = std::move(shown);
  }

  double chance() { return std::uniform_real_distribution<double>(0.0, 1.0)(rng_); }

  const World& world_;
  ViewerOptions options_;
  RgbdCamera camera_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  std::vector<std::uint32_t> shown_;
};

/// SLAM over a walk, and what was true. Frames are numbered from 0.
struct Walk {
  std::vector<Rigid3> T_world_camera;             ///< per frame
  std::vector<FrameReport> reports;               ///< per frame
  std::vector<std::vector<std::uint32_t>> shown;  ///< per frame and feature: the point of the world
};

/// Changes a view before SLAM gets it.
using Disturbance = std::function<void(std::uint64_t frame, FrameFeatures*)>;

inline Walk walk_through(Viewer* viewer, const std::vector<Rigid3>& T_world_camera, Slam* slam, const Disturbance& disturb = {}) {
  Walk walk;
  walk.T_world_camera = T_world_camera;
  for (std::uint64_t frame = 0; frame < T_world_camera.size(); ++frame) {
    FrameFeatures view = viewer->see(frame, T_world_camera[frame]);
    walk.shown.push_back(viewer->shown());
    if (disturb) disturb(frame, &view);
    walk.reports.push_back(slam->add_view(frame, view));
  }
  return walk;
}

inline SlamOptions walk_options() {
  SlamOptions options;
  options.orb.num_features = 600;
  options.numbers.min_segment_features = 100;
  return options;
}

/// Root mean square distance between the poses of a segment and the truth after the best rigid alignment, metres.
inline double trajectory_error_m(const SlamResult& result, std::uint32_t segment, const std::vector<Rigid3>& T_world_camera) {
  std::vector<PointPair> pairs;
  for (const SlamPose& pose : result.poses) {
    if (pose.segment == segment)
      pairs.push_back({.p_a = T_world_camera[static_cast<std::size_t>(pose.frame)].translation, .p_b = pose.T_map_camera.translation});
  }
  return align_rigid(pairs).rms_m;
}

/// Around a circle of `radius_m`, looking outwards.
inline std::vector<Rigid3> circle(std::size_t num_views, double radius_m, double begin_rad, double end_rad) {
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < num_views; ++i) {
    const double yaw = begin_rad + (end_rad - begin_rad) * static_cast<double>(i) / static_cast<double>(num_views - 1);
    poses.push_back(looking({radius_m * std::cos(yaw), radius_m * std::sin(yaw), 1.5 + 0.1 * std::sin(5 * yaw)}, yaw, -0.1));
  }
  return poses;
}

/// Along the middle of a ring, `begin_m` to `end_m` of the way around, turning in the corners.
inline std::vector<Rigid3> along_ring(double side_m, double begin_m, double end_m, double step_m) {
  std::vector<Rigid3> poses;
  const Eigen::Vector2d corners[] = {{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}};
  for (double s = begin_m; s < end_m; s += step_m) {
    const auto edge = static_cast<int>(std::floor(s / side_m));
    const double along = s - edge * side_m, ahead = side_m - along;
    // Looks ahead; within the last metre before and the first after a corner it turns.
    double yaw = edge * std::numbers::pi / 2;
    if (ahead < 1) yaw += (1 - ahead) * std::numbers::pi / 4;
    if (along < 1) yaw -= (1 - along) * std::numbers::pi / 4;
    const double direction = edge * std::numbers::pi / 2;
    const Eigen::Vector2d p = corners[edge % 4] + along * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    poses.push_back(looking({p.x(), p.y(), 1.5 + 0.02 * std::sin(3 * s)}, yaw));
  }
  return poses;
}

}  // namespace camloc::testing
