// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One view against the landmarks of a generated room: the true pose with and without a prediction, none where there is none.
#include "core/registration/frame_registration.h"

#include <gtest/gtest.h>

#include "core/slam/keyframe_insertion.h"
#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

using testing::looking;
using testing::Viewer;
using testing::World;

/// A map of keyframes at true poses.
struct SeenRoom {
  World world = testing::make_room();
  Viewer viewer{world};
  SlamMap map{viewer.camera(), 1.2F, 8};
  PoseSolver solver{viewer.camera(), map.levels(), mapping_solver_options(600)};
  LandmarkSet landmarks = map.empty_landmark_set();

  SeenRoom() {
    std::vector<std::uint32_t> keyframes;
    for (std::uint64_t k = 0; k < 4; ++k) {
      const Rigid3 T = looking({0.1 * static_cast<double>(k), 0, 1.4}, 0.15 * static_cast<double>(k) - 0.2);
      FrameFeatures view = viewer.see(k, T);
      view.T_map_camera = T;
      keyframes.push_back(insert_keyframe(k, 0, view, {}, &map));
    }
    map.collect_landmarks(keyframes, 4000, &landmarks);
  }
};

const Rigid3 kTruth = looking({0.15, 0.1, 1.45}, 0.05, -0.05);

void expect_near_truth(const Registration& found) {
  ASSERT_TRUE(found.is_found);
  EXPECT_LT((found.T_map_camera.translation - kTruth.translation).norm(), 0.01);
  EXPECT_LT(rotation_distance_rad(found.T_map_camera.rotation, kTruth.rotation), 0.004);
  EXPECT_GE(found.num_inliers, 150U);
  EXPECT_LE(found.num_inliers, found.num_matches);
  EXPECT_LE(found.num_matches, found.num_visible);
  EXPECT_GT(found.inlier_ratio(), 0.7);
  EXPECT_GT(found.spread, 0.5);
  EXPECT_LE(found.spread, 1.0);
  EXPECT_GT(found.depth_agreement, 0.9);
  EXPECT_LT(found.median_px, 1.5);
}

TEST(ViewRegistration, FindsThePoseWithAPrediction) {
  SeenRoom f;
  const FrameFeatures view = f.viewer.see(10, kTruth);
  const Rigid3 predicted{kTruth.rotation * exp_so3({0.01, -0.012, 0.005}), kTruth.translation + Eigen::Vector3d(0.03, -0.02, 0.02)};
  expect_near_truth(register_near(view, predicted, 14, 1, &f.landmarks, &f.solver));
}

TEST(ViewRegistration, FindsThePoseFromDescriptorsAlone) {
  SeenRoom f;
  expect_near_truth(register_anywhere(f.viewer.see(10, kTruth), 1, &f.landmarks, &f.solver));
}

TEST(ViewRegistration, InliersShowTheLandmarksTheyName) {
  SeenRoom f;
  const FrameFeatures view = f.viewer.see(10, kTruth);
  const Registration found = register_anywhere(view, 1, &f.landmarks, &f.solver);
  std::size_t num_right = 0;
  for (const LandmarkObservation& pair : found.inliers) {
    const Eigen::Vector3d truth = f.world.points[f.viewer.shown()[pair.feature]].position_m;
    num_right += (f.map.landmark(pair.landmark).position_m - truth).norm() < 0.15 ? 1U : 0U;
  }
  EXPECT_GE(num_right, found.inliers.size() * 98 / 100);
}

TEST(ViewRegistration, AWrongPredictionIsRefusedAndNotFollowed) {
  SeenRoom f;
  const FrameFeatures view = f.viewer.see(10, kTruth);
  const Registration found = register_near(view, looking({0.1, 0, 1.4}, 0.9), 14, 1, &f.landmarks, &f.solver);
  EXPECT_FALSE(found.is_found);
  EXPECT_TRUE(found.inliers.empty());
}

TEST(ViewRegistration, NonsenseIsRefused) {
  SeenRoom f;
  // Another room, empty views, landmarks of nothing.
  const World other = testing::make_room(50);
  Viewer elsewhere(other);
  const FrameFeatures strange = elsewhere.see(10, kTruth), view = f.viewer.see(10, kTruth);
  EXPECT_FALSE(register_near(strange, kTruth, 14, 1, &f.landmarks, &f.solver).is_found);
  EXPECT_FALSE(register_anywhere(strange, 1, &f.landmarks, &f.solver).is_found);
  EXPECT_FALSE(register_near(FrameFeatures{}, kTruth, 14, 1, &f.landmarks, &f.solver).is_found);
  EXPECT_FALSE(register_anywhere(FrameFeatures{}, 1, &f.landmarks, &f.solver).is_found);
  LandmarkSet nothing = f.map.empty_landmark_set();
  f.map.collect_landmarks({}, 100, &nothing);
  EXPECT_FALSE(register_near(view, kTruth, 14, 1, &nothing, &f.solver).is_found);
  EXPECT_FALSE(register_anywhere(view, 1, &nothing, &f.solver).is_found);
}

TEST(ViewRegistration, DepthMakesThePoseBetter) {
  SeenRoom f;
  PoseSolver without(f.viewer.camera(), f.map.levels(), mapping_solver_options(600, false));
  double with_m = 0, without_m = 0;
  for (std::uint64_t i = 0; i < 25; ++i) {
    const FrameFeatures view = f.viewer.see(10 + i, kTruth);
    with_m += (register_near(view, kTruth, 14, i, &f.landmarks, &f.solver).T_map_camera.translation - kTruth.translation).norm();
    without_m += (register_near(view, kTruth, 14, i, &f.landmarks, &without).T_map_camera.translation - kTruth.translation).norm();
  }
  EXPECT_LT(with_m, without_m);
}

TEST(ViewRegistration, TheSameInputGivesTheSameBits) {
  SeenRoom f, g;
  const FrameFeatures view = f.viewer.see(10, kTruth);
  (void)register_anywhere(g.viewer.see(11, looking({0, 0, 1.4}, -0.2)), 9, &g.landmarks, &g.solver);  // what came before does not matter
  const Registration a = register_anywhere(view, 3, &f.landmarks, &f.solver), b = register_anywhere(view, 3, &g.landmarks, &g.solver);
  EXPECT_EQ(a.T_map_camera.translation, b.T_map_camera.translation);
  EXPECT_EQ(a.T_map_camera.rotation.coeffs(), b.T_map_camera.rotation.coeffs());
  EXPECT_EQ(a.num_inliers, b.num_inliers);
}

TEST(ViewRegistration, WrongDepthsLowerTheAgreement) {
  SeenRoom f;
  FrameFeatures view = f.viewer.see(10, kTruth);
  for (std::size_t i = 0; i < view.size(); i += 2) view.depth_m[i] *= 0.7F;
  const Registration found = register_anywhere(view, 1, &f.landmarks, &f.solver);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(found.depth_agreement, 0.7);
  EXPECT_LT((found.T_map_camera.translation - kTruth.translation).norm(), 0.05);
}

}  // namespace
}  // namespace camloc
