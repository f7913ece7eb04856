// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/mapmaking/map_assembly.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/map/map_writer.h"
#include "tests/map/room_map.h"

namespace camloc {
namespace {

using testing::Random;

/// Landmarks on a wall, each seen by a few of the views in a row; descriptors told apart by chance alone.
struct WallMap {
  MapParts parts;
  std::vector<std::vector<ViewObservation>> views;
  std::vector<Rigid3> poses;

  explicit WallMap(std::uint32_t num_landmarks, std::uint32_t num_views = 12, std::uint32_t descriptors = 1) {
    Random random(3);
    parts.camera = testing::room_camera();
    parts.pose_sigma_m = 0.0125;
    views.resize(num_views);
    for (std::uint32_t v = 0; v < num_views; ++v) poses.push_back(testing::looking({0.1 * v, 0, 1}, {0, 1, 0}));
    for (std::uint32_t i = 0; i < num_landmarks; ++i) {
      const std::uint32_t first = i * (num_views - 3) / num_landmarks;
      parts.landmarks.push_back(testing::room_landmark({0.1 * first, 2, random.uniform(0, 2)}, {0, -2, 0}, &random));
      for (std::uint32_t d = 1; d < descriptors; ++d) parts.landmarks.back().descriptors.push_back(random.descriptor());
      parts.support.emplace_back(descriptors, 3U);
      for (std::uint32_t v = first; v < first + 4; ++v) views[v].push_back({i, static_cast<std::uint8_t>(i % kNumCells)});
    }
    parts.views = views;
    parts.poses = poses;
  }
  WallMap(const WallMap&) = delete;
  WallMap& operator=(const WallMap&) = delete;
};

TEST(MapAssembly, KeepsEverythingWithoutABudget) {
  const WallMap wall(600);
  MapBuildReport report;
  const auto map = assemble_map(wall.parts, {}, &report);
  ASSERT_TRUE(map.is_ok()) << map.status().message();
  EXPECT_EQ(map.value().landmarks.size(), 600U);
  EXPECT_EQ(report.num_landmarks, 600U);
  EXPECT_EQ(report.num_keyframes_before, 12U);
  EXPECT_EQ(report.num_keyframes, map.value().keyframes.size());
  EXPECT_LT(map.value().keyframes.size(), 12U);
  EXPECT_EQ(report.file_bytes, serialize_map(map.value()).value().size());
  EXPECT_EQ(map.value().pose_sigma_m, 0.0125);
  std::vector<int> times_seen(600, 0);
  for (const MapKeyframe& keyframe : map.value().keyframes) {
    for (const std::uint32_t i : keyframe.landmarks) ++times_seen[i];
  }
  EXPECT_EQ(std::count(times_seen.begin(), times_seen.end(), 0), 0);
}

TEST(MapAssembly, KeepsWhatIsWorthMost) {
  WallMap wall(3000);
  // Every other landmark would be seen again by many more frames than the views that are left say.
  for (std::uint32_t i = 0; i < 3000; ++i) wall.parts.worth.push_back(i % 2 == 0 ? 4.0F : 40.0F);
  for (std::uint32_t i = 0; i < 3000; ++i) wall.parts.landmarks[i].num_observations = i % 2 == 0 ? 4 : 40;
  MapBuildOptions options;
  options.max_bytes = 60000;
  const auto map = assemble_map(wall.parts, options, nullptr);
  ASSERT_TRUE(map.is_ok()) << map.status().message();
  EXPECT_LE(serialize_map(map.value()).value().size(), options.max_bytes);
  const auto& landmarks = map.value().landmarks;
  const auto num_worthy = std::count_if(landmarks.begin(), landmarks.end(), [](const MapLandmark& l) { return l.num_observations == 40; });
  EXPECT_GT(static_cast<double>(num_worthy), 0.95 * static_cast<double>(landmarks.size()));
}

TEST(MapAssembly, LandmarksBelowTheLeastWorthGo) {
  WallMap wall(600);
  for (std::uint32_t i = 0; i < 600; ++i) wall.parts.worth.push_back(i < 300 ? 1.0F : 2.0F);
  const auto map = assemble_map(wall.parts, {}, nullptr);
  ASSERT_TRUE(map.is_ok());
  EXPECT_LT(map.value().landmarks.size(), 600U);
  EXPECT_GE(map.value().landmarks.size(), 300U);
}

TEST(MapAssembly, SetsBytesAsideForFurtherAppearances) {
  const WallMap wall(3000, 12, 2);
  MapBuildOptions options;
  options.max_bytes = 60000;
  const auto descriptors_of = [](const MapData& map) {
    std::size_t count = 0;
    for (const MapLandmark& l : map.landmarks) count += l.descriptors.size();
    return static_cast<double>(count);
  };
  const auto without = assemble_map(wall.parts, options, nullptr);
  options.appearance_share = 0.2;
  const auto with = assemble_map(wall.parts, options, nullptr);
  ASSERT_TRUE(without.is_ok() && with.is_ok());
  EXPECT_LE(serialize_map(with.value()).value().size(), options.max_bytes);
  EXPECT_LT(with.value().landmarks.size(), without.value().landmarks.size());
  EXPECT_GT(descriptors_of(with.value()), 1.2 * static_cast<double>(with.value().landmarks.size()));
  options.max_bytes = 0;
  const auto unlimited = assemble_map(wall.parts, options, nullptr);
  ASSERT_TRUE(unlimited.is_ok());
  EXPECT_EQ(descriptors_of(unlimited.value()), 2.0 * static_cast<double>(unlimited.value().landmarks.size()));
}

TEST(MapAssembly, FillsTheBudgetWhereAskedTo) {
  const WallMap wall(3000);
  MapBuildOptions options;
  options.max_bytes = 60000;
  const auto cautious = assemble_map(wall.parts, options, nullptr);
  options.fills_budget = true;
  MapBuildReport report;
  const auto filled = assemble_map(wall.parts, options, &report);
  ASSERT_TRUE(cautious.is_ok() && filled.is_ok());
  EXPECT_GT(filled.value().landmarks.size(), cautious.value().landmarks.size());
  EXPECT_LE(report.file_bytes, options.max_bytes);
  EXPECT_GE(report.file_bytes, 0.95 * static_cast<double>(options.max_bytes));
  EXPECT_EQ(report.file_bytes, serialize_map(filled.value()).value().size());
}

TEST(MapAssembly, SaysWhenTheBudgetIsTooSmall) {
  const WallMap wall(600);
  MapBuildOptions options;
  options.max_bytes = 1000;
  const auto map = assemble_map(wall.parts, options, nullptr);
  ASSERT_FALSE(map.is_ok());
  EXPECT_NE(map.status().message().find("raise the byte budget"), std::string::npos);
}

}  // namespace
}  // namespace camloc
