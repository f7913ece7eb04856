// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Places whose outlook is known: a rich room, a bare wall, a corridor of identical bays.
#include "core/mapmaking/localizability.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "core/geometry/pose_refinement.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "core/registration/keypoint_noise.h"
#include "tests/mapmaking/bay_map.h"

namespace camloc {
namespace {

using testing::add_wall;
using testing::empty_map;
using testing::landmarks_in_view;
using testing::looking;
using testing::make_corridor;
using testing::make_room_map;
using testing::one_view_a_bay;
using testing::Random;
using testing::room_landmark;

/// What a map says when all keyframes are made from `poses` and see what is in view.
std::vector<KeyframeLocalizability> assess(MapData map, const std::vector<Rigid3>& poses, const LocalizabilityOptions& options = {}) {
  testing::set_keyframes(&map, poses);
  const testing::TemporaryFolder folder;
  const Status written = write_map(map, folder.file("m.cmap"));
  EXPECT_TRUE(written.is_ok()) << written.message();
  const auto view = MapView::open(folder.file("m.cmap"));
  EXPECT_TRUE(view.is_ok());
  return assess_localizability(*view, options);
}

TEST(LocalizabilityTest, InARichRoomAFixIsLikely) {
  const MapData room = make_room_map({.landmarks_per_wall = 500});
  std::vector<Rigid3> poses;
  for (const MapKeyframe& keyframe : room.keyframes) poses.push_back(keyframe.T_map_camera);
  const auto places = assess(room, poses);
  ASSERT_EQ(places.size(), 9U);
  for (const KeyframeLocalizability& place : places) {
    EXPECT_EQ(place.outlook, FixOutlook::kLikely) << place.num_landmarks << " landmarks, spread " << place.spread;
    EXPECT_GT(place.num_landmarks, 100U);
    EXPECT_GT(place.spread, 0.5);
    EXPECT_LT(place.position_sigma_m, 0.02);
    EXPECT_GT(place.position_sigma_m, 0.0001);
    EXPECT_LT(place.rival ? place.rival->num_inliers : 0U, 15U);
  }
}

TEST(LocalizabilityTest, IdenticalBaysLookAlike) {
  const auto places = assess(make_corridor(5, 12), one_view_a_bay(5));
  ASSERT_EQ(places.size(), 5U);
  for (std::uint32_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(places[i].rival.has_value());
    EXPECT_EQ(places[i].outlook, FixOutlook::kLookAlike);
    EXPECT_NE(places[i].rival->keyframe, i);
    EXPECT_GT(places[i].rival->matched_share, 0.8);
    EXPECT_GT(places[i].rival->num_inliers, places[i].num_landmarks / 2);
  }
}

TEST(LocalizabilityTest, BaysOfDifferentTextureDoNot) {
  const auto places = assess(make_corridor(5, 400), one_view_a_bay(5));
  for (const KeyframeLocalizability& place : places) EXPECT_EQ(place.outlook, FixOutlook::kLikely);
}

TEST(LocalizabilityTest, ABareWallIsToBeScannedAgain) {
  MapData map = empty_map();
  Random random(2);
  add_wall(&map, 0, 4, 300, &random);
  add_wall(&map, 8, 12, 20, &random);
  const auto places = assess(map, {looking({2, -0.5, 1.4}, {0, 1, 0}), looking({10, -0.5, 1.4}, {0, 1, 0})});
  EXPECT_EQ(places[0].outlook, FixOutlook::kLikely);
  EXPECT_EQ(places[1].outlook, FixOutlook::kScanAgain);
  EXPECT_EQ(places[1].weakness, FixWeakness::kFewLandmarks);
  EXPECT_GT(places[1].position_sigma_m, 2 * places[0].position_sigma_m);
}

TEST(LocalizabilityTest, LandmarksThatOneFrameSawDoNotCount) {
  MapData map = empty_map();
  Random random(2);
  add_wall(&map, 0, 4, 300, &random);
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) map.landmarks[i].num_observations = i % 10 == 0 ? 2 : 1;
  const auto places = assess(map, {looking({2, -0.5, 1.4}, {0, 1, 0})});
  EXPECT_LT(places[0].num_landmarks, 30U);
  EXPECT_EQ(places[0].weakness, FixWeakness::kFewLandmarks);
}

TEST(LocalizabilityTest, OnePosterOnAWallSpreadsPoorly) {
  MapData map = empty_map();
  Random random(2);
  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector3d p(2 + random.uniform(-0.2, 0.2), 2, 1.4 + random.uniform(-0.2, 0.2));
    map.landmarks.push_back(room_landmark(p, Eigen::Vector3d(2, 0, 1.4) - p, &random));
  }
  const auto places = assess(map, {looking({2, -0.5, 1.4}, {0, 1, 0})});
  EXPECT_EQ(places[0].weakness, FixWeakness::kPoorSpread);
}

TEST(LocalizabilityTest, WhatIsFarAndUncertainIsImprecise) {
  MapData map = empty_map();
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p(random.uniform(-12, 12), 20, random.uniform(-6, 8));
    map.landmarks.push_back(room_landmark(p, Eigen::Vector3d(0, 0, 1.4) - p, &random));
    map.landmarks.back().position_sigma_m = 0.5F;
  }
  const auto places = assess(map, {looking({0, 0, 1.4}, {0, 1, 0})});
  EXPECT_EQ(places[0].outlook, FixOutlook::kScanAgain);
  EXPECT_EQ(places[0].weakness, FixWeakness::kImprecise);
}

TEST(LocalizabilityTest, TheSamePlaceMappedTwiceIsNoRival) {
  MapData map = empty_map();
  Random random(2);
  add_wall(&map, -2, 6, 600, &random);
  const std::size_t count = map.landmarks.size();
  for (std::size_t i = 0; i < count; ++i) {  // five centimetres off: the second view did not recognise them
    MapLandmark again = map.landmarks[i];
    again.position_m.z() += 0.05F;
    map.landmarks.push_back(again);
  }
  map.keyframes.push_back({looking({2, -0.5, 1.4}, {0, 1, 0}), {}});
  map.keyframes.push_back({looking({2, -4, 1.4}, {0, 1, 0}), {}});
  for (std::size_t k = 0; k < 2; ++k) {
    for (const std::uint32_t landmark : landmarks_in_view(map, map.keyframes[k].T_map_camera)) {
      if ((landmark < count) == (k == 0)) map.keyframes[k].landmarks.push_back(landmark);
    }
  }
  std::vector<Descriptor> descriptors;
  for (const MapLandmark& landmark : map.landmarks) descriptors.push_back(landmark.descriptors[0]);
  map.words = train_vocabulary(descriptors, 64);
  build_inverted_file(&map);
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_map(map, folder.file("m.cmap")).is_ok());
  const auto view = MapView::open(folder.file("m.cmap"));
  ASSERT_TRUE(view.is_ok());
  for (const KeyframeLocalizability& place : assess_localizability(*view)) {
    ASSERT_TRUE(place.rival.has_value());
    EXPECT_EQ(place.rival->num_matches, 0U);
    EXPECT_EQ(place.outlook, FixOutlook::kLikely);
  }
}

double gaussian(Random* random) {
  const double radius = std::sqrt(-2 * std::log(random->uniform(1e-12, 1)));
  return radius * std::cos(random->uniform(0, 2 * std::numbers::pi));
}

/// Square root of the largest eigenvalue of the position covariance over `num_trials` noisy localizations of one view.
double measured_position_sigma_m(const MapData& map, const Rigid3& T_map_camera, int num_trials) {
  const std::vector<std::uint32_t> seen = landmarks_in_view(map, T_map_camera);
  const double focal_px = map.camera.color.mean_focal_px();
  PoseRefinementOptions options;
  options.depth_noise = map.camera.depth_noise;
  const float sigma_px = pair_sigma_px(1, kMapLandmarkSigmaPx);
  Random random(4);
  Correspondences pairs(seen.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int trial = 0; trial < num_trials; ++trial) {
    pairs.clear();
    for (const std::uint32_t landmark : seen) {
      const Eigen::Vector3f& P = map.landmarks[landmark].position_m;
      const Eigen::Vector3d p = T_map_camera.inverse() * P.cast<double>();
      const double sigma = sigma_px / focal_px;
      const double u = p.x() / p.z() + gaussian(&random) * sigma, v = p.y() / p.z() + gaussian(&random) * sigma;
      const double depth = p.z() + gaussian(&random) * map.camera.depth_noise.sigma_m(p.z());
      pairs.add(static_cast<float>(u), static_cast<float>(v), P.x(), P.y(), P.z(), static_cast<float>(depth), sigma_px, 0.0F, 0, 0);
    }
    const Eigen::Vector3d error =
        refine_pose(pairs, T_map_camera, focal_px, options, nullptr).T_map_camera.translation - T_map_camera.translation;
    covariance += error * error.transpose() / num_trials;
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]);
}

TEST(LocalizabilityTest, ExpectedSigmaIsWhatNoiseDoesToAPose) {
  MapData map = empty_map();
  Random random(2);
  add_wall(&map, 0, 4, 200, &random);
  const Rigid3 pose = looking({2, -0.5, 1.4}, {0.2, 1, -0.1});
  for (MapLandmark& landmark : map.landmarks) {
    landmark.position_sigma_m = 0;
    landmark.min_reference_m = landmark.max_reference_m = (landmark.position_m.cast<double>() - pose.translation).cast<float>().norm();
  }
  const double measured_m = measured_position_sigma_m(map, pose, 400);
  EXPECT_NEAR(assess(map, {pose}, {.repeatability = 1})[0].position_sigma_m / measured_m, 1, 0.2);
}

TEST(LocalizabilityTest, MoreNoiseMeansMoreSigma) {
  MapData map = empty_map();
  Random random(2);
  add_wall(&map, 0, 4, 300, &random);
  const std::vector<Rigid3> poses = {looking({2, -0.5, 1.4}, {0, 1, 0})};
  const double sigma = assess(map, poses)[0].position_sigma_m;
  MapData scattered = map;
  for (MapLandmark& landmark : scattered.landmarks) landmark.position_sigma_m += 0.05F;
  EXPECT_GT(assess(scattered, poses)[0].position_sigma_m, 1.2 * sigma);
  map.pose_sigma_m = 0.03;
  EXPECT_GE(assess(map, poses)[0].position_sigma_m, 0.03);
}

TEST(LocalizabilityTest, AMapWithoutAViewOfItsLandmarksIsWeakButNoCrash) {
  const MapData map = testing::make_synthetic_map({.num_words = 0});
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_map(map, folder.file("m.cmap")).is_ok());
  const auto view = MapView::open(folder.file("m.cmap"));
  ASSERT_TRUE(view.is_ok());
  const auto places = assess_localizability(*view);
  ASSERT_EQ(places.size(), 3U);
  for (const KeyframeLocalizability& place : places) EXPECT_EQ(place.outlook, FixOutlook::kScanAgain);
}

}  // namespace
}  // namespace camloc
