// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two generated days: the motion between their maps is found, drift is bent away, the same points become one landmark, and what
// does not fit together is refused.
#include "core/merge/map_merging.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/map/map_writer.h"
#include "tests/base/recording_observer.h"
#include "tests/merge/two_days.h"

namespace camloc {
namespace {

using testing::Corridor;
using testing::DayOptions;
using testing::make_corridor;
using testing::make_day;

DayOptions second_day() {
  DayOptions options;
  options.seed = 2;
  options.T_day_world = {Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d(0.1, 0, 1).normalized())), {3, -7, 0.5}};
  return options;
}

class MapMergingTest : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    const std::string path = folder_.file("map" + std::to_string(num_files_++) + ".cmap");
    const Status written = write_map(data, path);
    EXPECT_TRUE(written.is_ok()) << written.message();
    return MapView::open(path).value();
  }
  Result<MapData> merge(const MapData& a, const MapData& b) {
    report_ = {};
    return merge_maps(open(a), b, options_, WorkObserver::nobody(), &report_);
  }
  testing::TemporaryFolder folder_;
  int num_files_ = 0;
  MapMergeOptions options_;
  MapMergeReport report_;
};

/// Share of landmarks that lie within `limit_m` of a point of the corridor, in the frame of day 1 (the world).
double share_on_points(const MapData& map, const Corridor& corridor, double limit_m) {
  std::size_t num_near = 0;
  for (const MapLandmark& landmark : map.landmarks) {
    const bool is_near = std::any_of(corridor.points.begin(), corridor.points.end(), [&](const Corridor::Point& p) {
      return (p.position_m - landmark.position_m.cast<double>()).norm() < limit_m;
    });
    num_near += is_near ? 1 : 0;
  }
  return static_cast<double>(num_near) / static_cast<double>(map.landmarks.size());
}

TEST_F(MapMergingTest, FindsTheMotionAndFusesWhatBothSaw) {
  const Corridor corridor = make_corridor(1);
  const MapData a = make_day(corridor, {}), b = make_day(corridor, second_day());
  const auto merged = merge(a, b);
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  EXPECT_GT(report_.num_localized, b.keyframes.size() * 9 / 10);
  const Rigid3 error = report_.alignment.T_a_b * second_day().T_day_world;
  EXPECT_LT((error * Eigen::Vector3d(10, 0, 1.5) - Eigen::Vector3d(10, 0, 1.5)).norm(), 0.01);
  EXPECT_LT(rotation_distance_rad(error.rotation, Eigen::Quaterniond::Identity()), 0.002);
  std::size_t num_common = 0;
  for (const MapLandmark& in_b : b.landmarks) {
    const Eigen::Vector3d p = second_day().T_day_world.inverse() * in_b.position_m.cast<double>();
    num_common += std::any_of(a.landmarks.begin(), a.landmarks.end(),
                              [&](const MapLandmark& in_a) { return (in_a.position_m.cast<double>() - p).norm() < 0.01; });
  }
  EXPECT_NEAR(report_.num_fused, static_cast<double>(num_common), 0.03 * static_cast<double>(num_common));
  EXPECT_EQ(report_.num_fused + report_.num_added, b.landmarks.size());
  EXPECT_GT(share_on_points(merged.value(), corridor, 0.01), 0.99);
}

TEST_F(MapMergingTest, FusedLandmarksAreSeenByKeyframesOfBothDays) {
  const Corridor corridor = make_corridor(1);
  const MapData a = make_day(corridor, {}), b = make_day(corridor, second_day());
  const auto merged = merge(a, b);
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  const auto num_more = std::count_if(merged.value().landmarks.begin(), merged.value().landmarks.end(),
                                      [](const MapLandmark& l) { return l.num_observations == 12; });
  EXPECT_NEAR(static_cast<double>(num_more), report_.num_fused, 0.05 * report_.num_fused);
  std::vector<std::uint32_t> times_seen(merged.value().landmarks.size(), 0);
  for (const MapKeyframe& keyframe : merged.value().keyframes) {
    EXPECT_TRUE(std::is_sorted(keyframe.landmarks.begin(), keyframe.landmarks.end()));
    for (const std::uint32_t i : keyframe.landmarks) ++times_seen[i];
  }
  EXPECT_EQ(std::count(times_seen.begin(), times_seen.end(), 0U), 0);
  EXPECT_LT(merged.value().keyframes.size(), a.keyframes.size() + b.keyframes.size());
}

TEST_F(MapMergingTest, BendsTheSecondMapOntoTheFirst) {
  const Corridor corridor = make_corridor(1);
  DayOptions drifting = second_day();
  drifting.curvature_per_m = 0.002;  // 0.4 m beside the corridor at its end
  const auto merged = merge(make_day(corridor, {}), make_day(corridor, drifting));
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  EXPECT_GT(report_.alignment.deformation_m, 0.05);
  EXPECT_GT(share_on_points(merged.value(), corridor, 0.03), 0.97);
  EXPECT_GT(report_.num_fused, report_.num_added);
}

TEST_F(MapMergingTest, AddsAStretchThatTheFirstDayDidNotSee) {
  const Corridor corridor = make_corridor(1);
  DayOptions first, second = second_day();
  first.last_m = 12;
  second.first_m = 6;
  const auto merged = merge(make_day(corridor, first), make_day(corridor, second));
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  EXPECT_LT(report_.num_localized, report_.num_keyframes_b);
  const auto num_beyond = std::count_if(merged.value().landmarks.begin(), merged.value().landmarks.end(),
                                        [](const MapLandmark& l) { return l.position_m.x() > 15; });
  EXPECT_GT(num_beyond, 200);
  EXPECT_GT(share_on_points(merged.value(), corridor, 0.03), 0.98);
}

TEST_F(MapMergingTest, AnotherLookBecomesAFurtherDescriptor) {
  const Corridor corridor = make_corridor(1);
  DayOptions changed = second_day();
  changed.changed_share = 0.4;
  const auto merged = merge(make_day(corridor, {}), make_day(corridor, changed));
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  EXPECT_GT(report_.num_appearances, 0.2 * report_.num_fused);
  const auto num_two = std::count_if(merged.value().landmarks.begin(), merged.value().landmarks.end(),
                                     [](const MapLandmark& l) { return l.descriptors.size() == 2; });
  EXPECT_GT(static_cast<double>(num_two), 0.9 * report_.num_appearances);
}

TEST_F(MapMergingTest, RefusesMapsOfDifferentPlaces) {
  const auto merged = merge(make_day(make_corridor(1), {}), make_day(make_corridor(9), second_day()));
  ASSERT_FALSE(merged.is_ok());
  EXPECT_EQ(merged.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(merged.status().message().find("no place in common that was seen with certainty"), std::string::npos);
}

TEST_F(MapMergingTest, RefusesAStretchThatFitsInTwoPlaces) {
  // The corridor repeats itself every 10 m; the second day has seen only half of it.
  const Corridor corridor = make_corridor(1, 20, 10);
  DayOptions half = second_day();
  half.first_m = 2;
  half.last_m = 8;
  const auto merged = merge(make_day(corridor, {}), make_day(corridor, half));
  ASSERT_FALSE(merged.is_ok());
  EXPECT_EQ(merged.status().code(), ErrorCode::kInvalid);
}

TEST_F(MapMergingTest, ObeysTheByteBudget) {
  const Corridor corridor = make_corridor(1);
  const MapData a = make_day(corridor, {}), b = make_day(corridor, second_day());
  options_.map.max_bytes = 60000;
  const auto merged = merge(a, b);
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  const auto bytes = serialize_map(merged.value());
  ASSERT_TRUE(bytes.is_ok());
  EXPECT_LE(bytes.value().size(), 60000U);
  EXPECT_GT(bytes.value().size(), 50000U);
  // What both days saw is kept rather than what one of them saw, by more than its share.
  const auto num_confirmed = std::count_if(merged.value().landmarks.begin(), merged.value().landmarks.end(),
                                           [](const MapLandmark& l) { return l.num_observations == 12; });
  EXPECT_GT(static_cast<double>(num_confirmed), 0.95 * report_.num_fused);
  EXPECT_LT(static_cast<double>(merged.value().landmarks.size()), 0.8 * (report_.num_added + report_.num_landmarks_a));
  EXPECT_EQ(bytes.value().size(), report_.map.file_bytes);
}

TEST_F(MapMergingTest, KeepsTheFirstDatumAndCarriesOverTheSecond) {
  const Corridor corridor = make_corridor(1);
  MapData a = make_day(corridor, {}), b = make_day(corridor, second_day());
  const Rigid3 T_wcs_world{Eigen::Quaterniond(Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitZ())), {3500100, 5400200, 110}};
  b.wcs.emplace();
  b.wcs->T_wcs_map = T_wcs_world * second_day().T_day_world.inverse();
  b.wcs->covariance = 1e-4 * Matrix6d::Identity();
  auto merged = merge(a, b);
  ASSERT_TRUE(merged.is_ok() && merged.value().wcs);
  EXPECT_TRUE(report_.is_datum_from_b);
  const Eigen::Vector3d p(10, 1, 1);
  EXPECT_LT((merged.value().wcs->T_wcs_map * p - T_wcs_world * p).norm(), 0.02);
  EXPECT_GE(merged.value().wcs->covariance(5, 5), 1e-4);
  a.wcs.emplace();
  a.wcs->T_wcs_map.translation = {1, 2, 3};
  merged = merge(a, b);
  ASSERT_TRUE(merged.is_ok() && merged.value().wcs);
  EXPECT_FALSE(report_.is_datum_from_b);
  EXPECT_EQ(merged.value().wcs->T_wcs_map.translation, Eigen::Vector3d(1, 2, 3));
}

TEST_F(MapMergingTest, RefusesMapsThatWereBuiltOtherwise) {
  const Corridor corridor = make_corridor(1);
  const MapData a = make_day(corridor, {});
  MapData b = make_day(corridor, second_day());
  b.orb_num_levels = 4;
  EXPECT_NE(merge(a, b).status().message().find("image pyramids"), std::string::npos);
  b = make_day(corridor, second_day());
  b.camera.color.fx = b.camera.color.fy = 1100;
  EXPECT_NE(merge(a, b).status().message().find("focal lengths"), std::string::npos);
}

TEST_F(MapMergingTest, SameMapsGiveTheSameBytesAndCanBeInterrupted) {
  const Corridor corridor = make_corridor(1);
  const MapData a = make_day(corridor, {}), b = make_day(corridor, second_day());
  const auto once = merge(a, b), again = merge(a, b);
  ASSERT_TRUE(once.is_ok() && again.is_ok());
  EXPECT_EQ(serialize_map(once.value()).value(), serialize_map(again.value()).value());
  testing::RecordingObserver all, five(5);
  ASSERT_TRUE(merge_maps(open(a), b, options_, all, &report_).is_ok());
  EXPECT_EQ(all.count("looking for places in common, keyframe"), report_.registration.num_queries);
  EXPECT_EQ(all.count("choosing landmarks and keyframes, training words ..."), 1U);
  const auto stopped = merge_maps(open(a), b, options_, five, &report_);
  EXPECT_EQ(stopped.status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(five.steps.size(), 5U);
  EXPECT_TRUE(five.is_monotone());
}

}  // namespace
}  // namespace camloc
