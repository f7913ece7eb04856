// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Keyframes moved off their true poses: what is adjusted, what is held, what is removed.
#include "core/slam/map_adjustment.h"

#include <gtest/gtest.h>

#include "tests/geometry/generated.h"
#include "tests/slam/true_keyframes.h"

namespace camloc {
namespace {

using testing::looking;
using testing::TrueKeyframes;

BundleOptions bundle_for(const RgbdCamera& camera) {
  BundleOptions bundle;
  bundle.focal_px = camera.color.mean_focal_px();
  bundle.depth_noise = camera.depth_noise;
  return bundle;
}

/// Six keyframes that share landmarks, all but the first disturbed.
struct Disturbed : TrueKeyframes {
  std::vector<Rigid3> truth;
  Disturbed() : TrueKeyframes(testing::make_room()) {
    for (int k = 0; k < 6; ++k) truth.push_back(looking({0.12 * k, 0.03 * k, 1.4}, 0.05 * k));
    std::vector<std::uint32_t> keyframes;
    for (const Rigid3& T : truth) {
      const std::uint32_t k = add(T);
      if (!keyframes.empty()) {
        LandmarkSet set = map.empty_landmark_set();
        map.collect_landmarks(keyframes, 4000, &set);
        fuse_into_keyframe(&set, k, 4, &solver, &map);
      }
      keyframes.push_back(k);
    }
    std::mt19937 rng(8);
    for (std::uint32_t k = 1; k < 6; ++k) {
      Rigid3& T = map.keyframe(k).view.T_map_camera;
      T = {T.rotation * exp_so3(testing::random_vector(rng, 0.004)), T.translation + testing::random_vector(rng, 0.015)};
    }
  }
  [[nodiscard]] double error_m() const {
    double sum = 0;
    for (std::uint32_t k = 0; k < 6; ++k) sum += (map.keyframe(k).view.T_map_camera.translation - truth[k].translation).norm();
    return sum / 6;
  }
};

TEST(MapAdjustment, LocalAdjustmentKeepsTheFirstKeyframeAndMendsTheOthers) {
  Disturbed d;
  const double before = d.error_m();
  const Rigid3 first = d.map.keyframe(0).view.T_map_camera;
  const MapFit fit = adjust_locally(bundle_for(d.viewer.camera()), {}, 5, &d.map);
  EXPECT_GT(fit.num_observations, 100U);
  EXPECT_LT(fit.median_px, 0.8);
  EXPECT_LT(fit.median_depth_sigmas, 1);
  EXPECT_EQ(d.map.keyframe(0).view.T_map_camera.translation, first.translation);
  EXPECT_EQ(d.map.keyframe(0).view.T_map_camera.rotation.coeffs(), first.rotation.coeffs());
  EXPECT_LT(d.error_m(), 0.4 * before);
  EXPECT_LT(d.error_m(), 0.006);
}

// Also where keyframes outside the window would hold it.
TEST(MapAdjustment, TheFirstKeyframeOfTheSegmentNeverMoves) {
  Disturbed d;
  SlamNumbers numbers;
  numbers.window_free_keyframes = 3;
  const Rigid3 first = d.map.keyframe(0).view.T_map_camera, second = d.map.keyframe(1).view.T_map_camera;
  adjust_locally(bundle_for(d.viewer.camera()), numbers, 0, &d.map);
  adjust_locally(bundle_for(d.viewer.camera()), numbers, 1, &d.map);
  EXPECT_EQ(d.map.keyframe(0).view.T_map_camera.translation, first.translation);
  EXPECT_EQ(d.map.keyframe(0).view.T_map_camera.rotation.coeffs(), first.rotation.coeffs());
  EXPECT_NE(d.map.keyframe(1).view.T_map_camera.translation, second.translation);
}

TEST(MapAdjustment, KeyframesOutsideTheWindowStay) {
  Disturbed d;
  SlamNumbers numbers;
  numbers.window_free_keyframes = 2;
  std::vector<Rigid3> before;
  for (const SlamKeyframe& k : d.map.keyframes()) before.push_back(k.view.T_map_camera);
  adjust_locally(bundle_for(d.viewer.camera()), numbers, 5, &d.map);
  int num_moved = 0;
  for (std::uint32_t k = 0; k < 6; ++k) num_moved += d.map.keyframe(k).view.T_map_camera.translation == before[k].translation ? 0 : 1;
  EXPECT_GE(num_moved, 1);
  EXPECT_LE(num_moved, 2);
}

TEST(MapAdjustment, GlobalAdjustmentReportsTheFitAndRemovesWhatDoesNotFit) {
  Disturbed d;
  // A wrong observation: another feature of the keyframe claims a landmark.
  std::uint32_t landmark = 0;
  while (d.map.landmark(landmark).observations.size() < 3 || d.map.landmark(landmark).observations.back().keyframe == 5) ++landmark;
  std::uint32_t feature = 0;
  while (d.map.keyframe(5).landmark_of_feature[feature] != kNoLandmark) ++feature;
  d.map.add_observation(landmark, {5, feature});
  const MapFit fit = adjust_globally(bundle_for(d.viewer.camera()), 0, {}, 3.0, &d.map);
  EXPECT_EQ(d.map.keyframe(5).landmark_of_feature[feature], kNoLandmark);
  EXPECT_LT(fit.median_px, 0.8);
  EXPECT_LT(fit.median_px, fit.p90_px);
  EXPECT_LT(fit.median_depth_sigmas, 1);
  EXPECT_GT(fit.median_depth_m, 0);
  EXPECT_LT(d.error_m(), 0.006);
}

TEST(MapAdjustment, AnotherSegmentIsNotTouched) {
  Disturbed d;
  const std::uint32_t other = d.add(looking({0, 0, 1.4}, 1.5), 1);
  const Rigid3 before = d.map.keyframe(other).view.T_map_camera;
  const Eigen::Vector3d landmark = d.map.landmarks().back().position_m;
  adjust_globally(bundle_for(d.viewer.camera()), 0, {}, 3.0, &d.map);
  EXPECT_EQ(d.map.keyframe(other).view.T_map_camera.translation, before.translation);
  EXPECT_EQ(d.map.landmarks().back().position_m, landmark);
  const MapFit fit = adjust_globally(bundle_for(d.viewer.camera()), 9, {}, 3.0, &d.map);  // there is no such segment
  EXPECT_EQ(fit.num_observations, 0U);
}

TEST(MapAdjustment, ControlLandmarksMoveTheMapToWhereTheyWereSurveyed) {
  Disturbed d;
  const Rigid3 T_site_map{exp_so3({0, 0, 0.02}), {0.05, -0.03, 0.02}};
  adjust_globally(bundle_for(d.viewer.camera()), 0, {}, 3.0, &d.map);
  std::vector<ControlLandmark> controls;
  for (std::uint32_t i = 0; i < d.map.landmarks().size() && controls.size() < 12; i += 5) {
    const SlamLandmark& landmark = d.map.landmark(i);
    if (landmark.observations.size() < 4) continue;
    ControlLandmark& control = controls.emplace_back();
    control.position_m = T_site_map * landmark.position_m;
    control.sigma_m = 0.0005;
    for (const Observation& s : landmark.observations) {
      const FrameFeatures& view = d.map.keyframe(s.keyframe).view;
      control.seen.push_back({s.keyframe, view.normalized[s.feature].x(), view.normalized[s.feature].y(), view.depth_m[s.feature], 0.5F});
    }
  }
  ASSERT_GE(controls.size(), 6U);
  std::vector<Rigid3> expected;
  for (const SlamKeyframe& k : d.map.keyframes()) expected.push_back(T_site_map * k.view.T_map_camera);
  const std::size_t num_landmarks = d.map.landmarks().size();
  adjust_globally(bundle_for(d.viewer.camera()), 0, {controls, {}}, 3.0, &d.map);
  for (std::uint32_t k = 0; k < 6; ++k) {
    EXPECT_LT((d.map.keyframe(k).view.T_map_camera.translation - expected[k].translation).norm(), 0.01);
    EXPECT_LT(rotation_distance_rad(d.map.keyframe(k).view.T_map_camera.rotation, expected[k].rotation), 0.005);
  }
  EXPECT_EQ(d.map.landmarks().size(), num_landmarks);  // nobody finds a control point by its looks
  // Two do not determine a frame: the first keyframe stays.
  const Rigid3 first = d.map.keyframe(0).view.T_map_camera;
  adjust_globally(bundle_for(d.viewer.camera()), 0, {std::span(controls).first(2), {}}, 3.0, &d.map);
  EXPECT_EQ(d.map.keyframe(0).view.T_map_camera.translation, first.translation);
}

// Their covariances promise a hundred times what they keep.
TEST(MapAdjustment, LinksThatDisagreeWithTheMapCountLess) {
  Disturbed alone, linked;
  adjust_globally(bundle_for(alone.viewer.camera()), 0, {}, 3.0, &alone.map);
  std::mt19937 rng(3);
  std::vector<PoseGraphEdge> links;
  for (std::uint32_t k = 1; k < 6; ++k) {
    const Rigid3 T_i_j = alone.map.keyframe(k - 1).view.T_map_camera.inverse() * alone.map.keyframe(k).view.T_map_camera;
    links.push_back({k - 1, k, testing::disturbed(rng, T_i_j, 0.05, 0.05), 1e-7 * Matrix6d::Identity()});
  }
  adjust_globally(bundle_for(linked.viewer.camera()), 0, {{}, links}, 3.0, &linked.map);
  EXPECT_LT(linked.error_m(), alone.error_m() + 0.003);
}

}  // namespace
}  // namespace camloc
