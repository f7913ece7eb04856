// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Against a walk over all landmarks in double precision: what is clearly in view is projected, what is clearly not is not.
#include "core/map/map_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "drivers/sample_source.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

enum class InView { kYes, kNo, kUnclear };

/// -1 clearly violated, +1 clearly kept, 0 too close to tell from single precision.
int side(double slack, double tolerance) { return slack > tolerance ? 1 : slack < -tolerance ? -1 : 0; }

InView in_view(const MapView& map, std::uint32_t landmark, const Rigid3& T_map_camera, const Intrinsics& camera,
               const MapLandmarksOptions& options, Eigen::Vector2d* pixel) {
  const auto& record = map.landmarks()[landmark];
  const Eigen::Vector3d p_map = map.position_m(landmark).cast<double>();
  const Eigen::Vector3d p = T_map_camera.inverse() * p_map;
  int worst = std::min(side(p.z() - 0.2, 1e-4), side(options.limits.max_range_m - p.z(), 1e-4));
  if (worst < 0) return InView::kNo;
  *pixel = camera.project(p);
  for (const double slack : {pixel->x(), pixel->y(), camera.width - 1 - pixel->x(), camera.height - 1 - pixel->y()}) {
    worst = std::min(worst, side(slack, 0.01));
  }
  const Eigen::Vector3d to_camera = T_map_camera.translation - p_map;
  const double angle = std::acos(std::clamp(to_camera.normalized().dot(MapView::direction(record).cast<double>()), -1.0, 1.0));
  const double widest = std::acos(std::clamp(static_cast<double>(MapView::view_cosine(record)), -1.0, 1.0));
  worst = std::min(worst, side(widest + options.limits.view_angle_margin_rad - angle, 2e-3));
  // Level at which a patch of its size would be found, from the nearest and the farthest view it was mapped from.
  const double log_scale = std::log(map.info().orb_scale_factor);
  const double low = std::log(MapView::reference_m(record.min_reference) / to_camera.norm()) / log_scale;
  const double high = std::log(MapView::reference_m(record.max_reference) / to_camera.norm()) / log_scale;
  worst = std::min({worst, side(std::ceil(high + 1e-3) + options.limits.level_margin + 0.5, 1e-3),
                    side(map.info().orb_num_levels - 0.5 - (std::floor(low - 1e-3) - options.limits.level_margin), 1e-3)});
  if (std::abs(high - std::round(high)) < 1e-3 || std::abs(low - std::round(low)) < 1e-3) worst = std::min(worst, 0);
  return worst > 0 ? InView::kYes : worst < 0 ? InView::kNo : InView::kUnclear;
}

const testing::MapOnDisk& flat() {
  static const testing::MapOnDisk map(testing::make_synthetic_map({.num_landmarks = 6000, .side_m = 14}));
  return map;
}

class MapLandmarksInView : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Poses, MapLandmarksInView, ::testing::Range(0, 20));

TEST_P(MapLandmarksInView, AreProjectedAndNoOthers) {
  const MapView& map = *flat().view;
  testing::Random random(static_cast<std::uint32_t>(GetParam()));
  const Rigid3 T_map_camera{random.rotation(), 6 * random.direction()};
  Intrinsics camera = sample_camera(640, 480).color;
  if (GetParam() % 2 == 1) {  // a barrel lens
    camera.lens = LensModel::kBrownConrady;
    camera.distortion = {-0.1, 0.01, 0.001, -0.002, 0};
  }
  const MapLandmarksOptions options{.max_landmarks = 6000, .max_cubes = 1000};
  MapLandmarks local(map, camera, options);
  std::map<std::uint32_t, ProjectedLandmark> projected;
  for (const auto& landmark : local.project(T_map_camera, 9.0F)) {
    EXPECT_TRUE(projected.emplace(static_cast<std::uint32_t>(landmark.landmark), landmark).second) << "twice";
  }
  int num_in_view = 0, num_not = 0;
  for (std::uint32_t i = 0; i < map.landmarks().size(); ++i) {
    Eigen::Vector2d pixel;
    const InView verdict = in_view(map, i, T_map_camera, camera, options, &pixel);
    if (verdict == InView::kUnclear) continue;
    ASSERT_EQ(projected.count(i), verdict == InView::kYes ? 1U : 0U) << "landmark " << i;
    if (verdict == InView::kNo) {
      ++num_not;
      continue;
    }
    ++num_in_view;
    const ProjectedLandmark& found = projected.at(i);
    EXPECT_NEAR(found.u, pixel.x(), 0.01);
    EXPECT_NEAR(found.v, pixel.y(), 0.01);
    EXPECT_EQ(found.radius_px, 9.0F);
    EXPECT_LE(found.min_level, found.max_level);
    EXPECT_LT(found.max_level, map.info().orb_num_levels);
    EXPECT_EQ(found.first_descriptor, map.first_descriptor(i));
    EXPECT_EQ(found.num_descriptors, map.num_descriptors(i));
  }
  EXPECT_GT(num_in_view, 5);
  EXPECT_GT(num_not, 4000);
}

/// A pose at which something is in view: from a corner towards the middle.
Rigid3 looking_in() {
  const Eigen::Vector3d at(-6, -5, -1);
  return {shortest_turn(Eigen::Vector3d::UnitZ(), -at.normalized()), at};
}

TEST(MapLandmarks, KeepsTheMostObserved) {
  const MapView& map = *flat().view;
  const Intrinsics camera = sample_camera(640, 480).color;
  MapLandmarks all(map, camera, {.max_landmarks = 6000, .max_cubes = 1000});
  const auto everything = all.project(looking_in(), 5);
  std::set<std::int32_t> in_view;
  for (const auto& landmark : everything) in_view.insert(landmark.landmark);
  ASSERT_GT(in_view.size(), 60U);
  constexpr int kLimit = 40;
  ASSERT_LT(in_view.size(), 4U * kLimit) << "no more than are looked at before choosing";
  MapLandmarks some(map, camera, {.max_landmarks = kLimit, .max_cubes = 1000});
  std::set<std::int32_t> kept;
  int fewest_kept = 255, most_dropped = 0;
  for (const auto& landmark : some.project(looking_in(), 5)) {
    kept.insert(landmark.landmark);
    EXPECT_EQ(landmark.first_descriptor, map.first_descriptor(static_cast<std::uint32_t>(landmark.landmark)));
  }
  ASSERT_EQ(kept.size(), static_cast<std::size_t>(kLimit));
  for (const std::int32_t i : in_view) {
    const int observed = map.landmarks()[static_cast<std::size_t>(i)].num_observations;
    if (kept.count(i) != 0)
      fewest_kept = std::min(fewest_kept, observed);
    else
      most_dropped = std::max(most_dropped, observed);
  }
  EXPECT_GE(fewest_kept, most_dropped);
}

TEST(MapLandmarks, EveryLimitHolds) {
  const MapView& map = *flat().view;
  const Intrinsics camera = sample_camera(640, 480).color;
  const auto count = [&](const MapLandmarksOptions& options) { return MapLandmarks(map, camera, options).project(looking_in(), 5).size(); };
  const std::size_t all = count({.max_landmarks = 6000, .max_cubes = 1000});
  EXPECT_EQ(count({.max_landmarks = 1}), 1U);
  EXPECT_EQ(count({.max_landmarks = 6000, .max_cubes = 0}), 0U);
  EXPECT_EQ(count({.max_landmarks = 6000, .max_cubes = 1000, .max_visited = 0}), 0U);
  const std::size_t near = count({.max_landmarks = 6000, .max_cubes = 3}),
                    half = count({.max_landmarks = 6000, .max_cubes = 1000, .max_visited = 1500});
  EXPECT_LT(near, all);
  EXPECT_LT(half, all);
  EXPECT_LT(count({.max_landmarks = 6000, .max_cubes = 1000, .max_visited = 60000, .limits = {.max_range_m = 4}}), all);
}

TEST(MapLandmarks, AMappedViewIsSeenAgain) {
  const testing::SampleWorld& world = testing::SampleWorld::get();
  MapLandmarks local(world.map(), world.camera().color, {});
  std::vector<std::uint32_t> list(world.map().info().max_keyframe_landmarks);
  std::set<std::uint32_t> projected;
  for (const auto& landmark : local.project(world.map().keyframe_pose(0), 5))
    projected.insert(static_cast<std::uint32_t>(landmark.landmark));
  const std::size_t count = world.map().keyframe_landmarks(0, list);
  std::size_t num_seen = 0;
  for (std::size_t i = 0; i < count; ++i) num_seen += projected.count(list[i]);
  EXPECT_GT(count, 200U);
  EXPECT_GT(num_seen, count * 97 / 100);
}

}  // namespace
}  // namespace camloc
