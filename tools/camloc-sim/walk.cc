// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/camloc-sim/building.h"
#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// Collects the points of a walk.
class PathBuilder {
 public:
  PathBuilder(const FloorPlan& plan, double n) : plan_(plan), n_(n) {}

  void corridor(int side, double s) { corridor(side, s, n_); }
  void corridor(int side, double s, double n) {
    path_.push_back(plan_.sides[static_cast<std::size_t>(side)].place.point(s, n, 0).head<2>());
  }
  /// Round the corner from the end of `side` into the next one.
  void corner(int side) { corridor(side, plan_.sides[static_cast<std::size_t>(side)].length - n_); }
  /// In by the door, a turn around the room, and out again. `shift` moves the turn sideways.
  void office(std::size_t index, double shift, bool is_clockwise) {
    const Office& office = plan_.offices[index];
    const Placement place = office_place(plan_, office);
    const double gap = -kWallThickness - (office.is_outer ? n_ : kCorridorWidth - n_);
    const double right = office.width - 1.55;
    std::vector<Eigen::Vector2d> turn = {{1.5, 1.5},   {1.55 + shift, 2.5},  {2.2, 3.2 + shift},
                                         {right, 2.8}, {right, 1.9 + shift}, {2.3, 1.0}};
    if (!is_clockwise) std::reverse(turn.begin(), turn.end());
    const auto add = [&](double x, double y) { path_.push_back(place.point(x, y, 0).head<2>()); };
    add(1.37, gap);
    add(1.37, -0.1);
    add(1.37, 0.6);
    for (const Eigen::Vector2d& p : turn) add(p.x(), p.y());
    add(1.40, 0.5);
    add(1.37, -0.1);
    add(1.37, gap);
  }
  [[nodiscard]] std::vector<Eigen::Vector2d> take() { return std::move(path_); }

 private:
  const FloorPlan& plan_;
  double n_;
  std::vector<Eigen::Vector2d> path_;
};

void turn_back(PathBuilder* path, int side, double s, double sign) {
  path->corridor(side, s, 0.8);
  path->corridor(side, s + sign * 0.5, 0.8);
  path->corridor(side, s + sign * 0.6, 1.5);
  path->corridor(side, s, 1.5);
}

std::vector<Eigen::Vector2d> mapping_path(const FloorPlan& plan) {
  PathBuilder path(plan, 1.1);
  path.corridor(0, 1.5);
  for (int side = 0; side < static_cast<int>(plan.sides.size()); ++side) {
    for (std::size_t office = 0; office < plan.offices.size(); ++office) {
      if (plan.offices[office].side == side) path.office(office, 0.0, office % 2 == 0);
    }
    path.corner(side);
  }
  turn_back(&path, 0, 8.0, 1.0);
  path.corridor(0, 1.1);
  path.corridor(3, 12.0);
  return path.take();
}

std::vector<Eigen::Vector2d> other_day_path(const FloorPlan& plan) {
  PathBuilder path(plan, 1.32);
  path.corridor(3, 20.0);
  path.corridor(3, 26.0, 0.9);
  path.corner(3);
  path.office(0, 0.15, true);
  path.corridor(0, 15.0, 0.85);
  path.corridor(0, 34.0);
  path.office(2, 0.1, true);
  path.corner(0);
  path.corridor(1, 9.0, 0.85);
  path.office(4, -0.1, true);
  path.corner(1);
  path.office(5, 0.1, false);
  path.corridor(2, 15.0, 0.9);
  path.office(6, -0.1, false);  // the other way round than when mapped
  path.corner(2);
  path.office(7, 0.1, false);
  path.corridor(3, 20.0);
  path.corridor(3, 30.0, 0.9);
  turn_back(&path, 3, 34.0, 1.0);
  path.corridor(3, 28.0, 1.4);
  path.corridor(3, 16.0, 0.95);
  return path.take();
}

std::vector<Eigen::Vector2d> small_path(const FloorPlan& plan, std::uint32_t day) {
  PathBuilder path(plan, day == 1 ? 1.1 : 1.3);
  path.corridor(0, day == 1 ? 3.5 : 4.2);
  path.office(0, day == 1 ? 0.0 : 0.12, true);
  path.corner(0);
  path.corridor(1, day == 1 ? 6.3 : 5.6);  // past the second office's open door
  return path.take();
}

/// Time at which the trajectory comes nearest to a point.
double nearest_time(const Trajectory& trajectory, const Eigen::Vector2d& point) {
  double best_time = 0, best = 1e18;
  for (double t = 0; t < trajectory.duration_s(); t += 0.1) {
    const double squared = (trajectory.pose(t).translation.head<2>() - point).squaredNorm();
    if (squared < best) {
      best = squared;
      best_time = t;
    }
  }
  return best_time;
}

Passer passer(const World& world, int side, double s, double speed, double n, double around_s, std::uint32_t seed) {
  const Eigen::Vector2d point = world.plan.sides[static_cast<std::size_t>(side)].place.point(s, 1.1, 0).head<2>();
  const double time = nearest_time(world.trajectory, point);
  return {side, s, time, speed, n, time - around_s, time + around_s, seed};
}

WalkStyle walk_style(SceneKind kind, std::uint32_t day, std::uint32_t seed) {
  WalkStyle style;
  style.seed = hash32(seed, day, 900);
  if (kind == SceneKind::kSmall) {
    style.speed_m_s = 1.05;
    style.turn_rate_rad_s = 0.95;
  }
  if (day != 1) {
    style.height_m = 1.53;
    style.speed_m_s *= 0.95;
    style.pitch_rad = -0.06;
    style.look_rad = 0.30;
  }
  return style;
}

std::vector<Passer> plan_passers(const World& world) {
  const SceneOptions& options = world.options;
  if (options.day == 1) return {};
  const std::uint32_t seed = hash32(options.seed, options.day, 950);
  std::vector<Passer> result;
  if (options.kind == SceneKind::kSmall) {
    result.push_back(passer(world, 1, 1.5, -0.8, 0.5, 8.0, seed));
    result.push_back(passer(world, 1, 7.2, 0.0, 1.8, 1e6, seed + 1));
    return result;
  }
  result.push_back(passer(world, 0, 18.0, -1.0, 0.4, 14.0, seed));      // comes towards the camera
  result.push_back(passer(world, 1, 17.0, 0.95, 1.5, 12.0, seed + 1));  // walks ahead
  result.back().meet_s += 2.5;
  result.push_back(passer(world, 2, 20.0, -1.1, 0.4, 14.0, seed + 2));
  result.push_back(passer(world, 2, 48.0, 0.0, 0.35, 1e6, seed + 3));  // stands at the wall
  result.push_back(passer(world, 3, 12.0, -0.9, 1.85, 14.0, seed));
  return result;
}

}  // namespace

World make_world(const SceneOptions& options) {
  const FloorPlan plan = floor_plan(options.kind, options.seed);
  const std::vector<Eigen::Vector2d> path = options.kind == SceneKind::kSmall ? small_path(plan, options.day)
                                            : options.day == 1                ? mapping_path(plan)
                                                                              : other_day_path(plan);
  const Trajectory trajectory(path, walk_style(options.kind, options.day, options.seed));
  World world{options, plan, build_scene(plan, options), trajectory, {}};
  world.passers = plan_passers(world);
  return world;
}

std::vector<Surface> people_at(const World& world, double time_s) {
  Scene people;
  for (const Passer& p : world.passers) {
    if (time_s < p.from_time_s || time_s > p.to_time_s) continue;
    const CorridorSide& side = world.plan.sides[static_cast<std::size_t>(p.side)];
    const double s = p.meet_s + p.speed_m_s * (time_s - p.meet_time_s);
    if (s < 0.5 || s > side.length - 0.5) continue;
    const double stride = p.speed_m_s == 0 ? 0.0 : std::sin(2 * kPi * time_s * 0.9);
    const double facing = p.speed_m_s == 0 ? kPi : (p.speed_m_s > 0 ? 0.5 * kPi : -0.5 * kPi);
    add_person(&people, side.place.child(s, p.n, facing), p.seed, stride, 0);
  }
  for (Surface& surface : people.surfaces) world.scene.bake_light(&surface);
  return std::move(people.surfaces);
}

}  // namespace camloc::sim
