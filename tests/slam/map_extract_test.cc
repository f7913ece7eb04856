// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which part of the map an adjustment gets, what it holds fixed, and what of the solution comes back.
#include "core/slam/map_extract.h"

#include <gtest/gtest.h>

#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;

/// Six keyframes that share landmarks; the last two are a segment of their own where that is asked for.
struct Shared : testing::TrueKeyframes {
  explicit Shared(bool has_two_segments = false) : TrueKeyframes(testing::make_room()) {
    std::vector<std::uint32_t> keyframes;
    for (std::uint32_t k = 0; k < 6; ++k) {
      const bool is_second = has_two_segments && k >= 4;
      if (is_second && k == 4) keyframes.clear();
      add(looking({0.12 * k, 0.03 * k, 1.4}, 0.05 * k), is_second ? 1 : 0);
      if (!keyframes.empty()) {
        LandmarkSet set = map.empty_landmark_set();
        map.collect_landmarks(keyframes, 4000, &set);
        fuse_into_keyframe(&set, k, 4, &solver, &map);
      }
      keyframes.push_back(k);
    }
  }
};

TEST(MapExtract, AWindowMovesItsOwnKeyframesAndIsHeldByOthers) {
  const Shared s;
  SlamNumbers numbers;
  numbers.window_free_keyframes = 2;
  numbers.window_fixed_keyframes = 3;
  const MapExtract extract = extract_window(numbers, 5, s.map);
  ASSERT_EQ(extract.keyframes.size(), 5U);
  EXPECT_EQ(extract.keyframes[0], 5U);
  EXPECT_EQ(std::vector<std::uint8_t>({0, 0, 1, 1, 1}), extract.problem.is_camera_fixed);
  for (std::size_t c = 0; c < extract.keyframes.size(); ++c) EXPECT_EQ(extract.camera_of_keyframe[extract.keyframes[c]], c);
  for (const BundleObservation& o : extract.problem.observations) {
    ASSERT_LT(o.camera, extract.keyframes.size());
    ASSERT_LT(o.landmark, extract.landmarks.size());
  }
}

TEST(MapExtract, AWindowAlwaysHoldsOneKeyframe) {
  const Shared s;
  const MapExtract extract = extract_window({}, 5, s.map);
  ASSERT_EQ(extract.keyframes.size(), 6U);
  int num_fixed = 0;
  for (std::size_t c = 0; c < 6; ++c) num_fixed += extract.problem.is_camera_fixed[c];
  EXPECT_EQ(num_fixed, 1);
  EXPECT_EQ(extract.problem.is_camera_fixed[extract.camera_of_keyframe[0]], 1);
}

TEST(MapExtract, ASegmentIsItsOwnKeyframesAndLandmarksAlone) {
  const Shared s(true);
  const MapExtract first = extract_segment(0, {}, s.map), second = extract_segment(1, {}, s.map);
  EXPECT_EQ(first.keyframes, std::vector<std::uint32_t>({0, 1, 2, 3}));
  EXPECT_EQ(second.keyframes, std::vector<std::uint32_t>({4, 5}));
  EXPECT_EQ(second.problem.is_camera_fixed, std::vector<std::uint8_t>({1, 0}));
  EXPECT_GT(second.landmarks.size(), 20U);
  for (const std::uint32_t index : second.landmarks) EXPECT_GE(s.map.landmark(index).observations.front().keyframe, 4U);
}

TEST(MapExtract, ThreeControlPointsHoldTheMapAndAreNoLandmarksOfIt) {
  Shared s;
  std::vector<ControlLandmark> controls(3);
  for (std::size_t i = 0; i < 3; ++i) {
    controls[i].position_m = {1, static_cast<double>(i), 1};
    controls[i].seen = {{2, 0.1F, 0.1F, 0, 1}};
  }
  const MapExtract two = extract_segment(0, {.controls = std::span(controls).first(2), .links = {}}, s.map);
  EXPECT_EQ(two.problem.is_camera_fixed[0], 1);
  MapExtract three = extract_segment(0, {.controls = controls, .links = {}}, s.map);
  EXPECT_EQ(three.problem.is_camera_fixed, std::vector<std::uint8_t>(6, 0));
  EXPECT_EQ(three.problem.landmarks_m.size(), three.landmarks.size() + 3);
  for (Eigen::Vector3d& X : three.problem.landmarks_m) X.x() += 1;
  const std::size_t before = s.map.landmarks().size();
  write_back(three, &s.map);
  EXPECT_EQ(s.map.landmarks().size(), before);
}

// A depth camera that is bent makes all links disagree; then they count less, all alike.
TEST(MapExtract, LinksCountLessWhereTheyDisagreeWithTheMap) {
  const Shared s;
  const auto links_off_by = [&](double off_m) {
    std::vector<PoseGraphEdge> links;
    for (std::uint32_t k = 0; k + 1 < 6; ++k) {
      Rigid3 T = s.map.keyframe(k).view.T_map_camera.inverse() * s.map.keyframe(k + 1).view.T_map_camera;
      T.translation.x() += off_m;
      links.push_back({k, k + 1, T, 1e-4 * Matrix6d::Identity()});
    }
    return extract_segment(0, {.controls = {}, .links = links}, s.map).problem.links.front().covariance(0, 0);
  };
  EXPECT_DOUBLE_EQ(links_off_by(0.01), 1e-4);
  EXPECT_NEAR(links_off_by(0.1), 1e-4 * 100 / 5.35, 1e-8);
}

TEST(MapExtract, ALandmarkSeenOnceStaysWhereItsKeyframeSeesIt) {
  Shared s;
  MapExtract extract = extract_segment(0, {}, s.map);
  std::uint32_t alone = 0;
  while (s.map.landmark(alone).observations.size() != 1 || s.map.landmark(alone).observations[0].keyframe != 3) ++alone;
  const Eigen::Vector3d in_camera = s.map.keyframe(3).view.T_map_camera.inverse() * s.map.landmark(alone).position_m;
  extract.problem.T_map_camera[3].translation += Eigen::Vector3d(0.1, 0.2, 0.3);
  write_back(extract, &s.map);
  EXPECT_LT((s.map.keyframe(3).view.T_map_camera * in_camera - s.map.landmark(alone).position_m).norm(), 1e-12);
}

}  // namespace
}  // namespace camloc
