// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/pose_solver.h"

#include <gtest/gtest.h>

#include "core/map/map_landmarks.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

constexpr std::uint64_t kIndex = 22;

/// A solver for the sample map and a camera.
struct Solver {
  explicit Solver(const RgbdCamera& rgbd_camera)
      : camera(rgbd_camera), landmarks(SampleWorld::get().map(), camera.color, {}), solver(camera, PyramidLevels(1.2F, 8), {}) {}

  void observe(const FrameBuffer& buffer) {
    frame = buffer;
    ASSERT_TRUE(extractor.has_image(frame.view()));
    extractor.extract(frame.view(), &view);
    solver.begin(view, extractor.depth_of(frame.view()));
  }
  std::span<const Match> search(const Rigid3& T_map_camera, float radius_px) {
    return solver.search_by_projection(&landmarks, T_map_camera, radius_px);
  }
  PoseEvidence solve(std::span<const Match> matches) { return solver.solve(landmarks, matches, 1); }
  PoseEvidence refine(const Rigid3& T_map_camera) { return solver.refine(&landmarks, T_map_camera); }

  RgbdCamera camera;
  FrameExtractor extractor{camera, OrbOptions{}};
  MapLandmarks landmarks;
  PoseSolver solver;
  FrameBuffer frame;
  FrameFeatures view;
};

class PoseSolverTest : public ::testing::Test {
 protected:
  void observe(const FrameBuffer& frame) { s_.observe(frame); }
  /// The frame seen again from its true pose.
  PoseEvidence look_from_truth() { return s_.refine(truth_); }

  const SampleWorld& world_ = SampleWorld::get();
  const Rigid3 truth_ = sample_pose(kIndex);
  Solver s_{world_.camera()};
};

TEST_F(PoseSolverTest, GuidedMatchesGiveThePose) {
  observe(world_.frame(kIndex));
  const auto matches = s_.search(truth_, 12);
  ASSERT_GT(matches.size(), 300U);
  const PoseEvidence found = s_.solve(matches);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(pose_error(truth_, found.T_map_camera).norm(), 0.02);
  EXPECT_EQ(found.num_matches, matches.size());
  const PoseEvidence again = s_.refine(found.T_map_camera);
  ASSERT_TRUE(again.is_found);
  EXPECT_LT(pose_error(truth_, again.T_map_camera).norm(), 0.006);
  EXPECT_GE(again.num_inliers, found.num_inliers);
  EXPECT_LE(again.num_inliers, again.num_matches);
  EXPECT_LE(again.num_matches, again.num_visible);
  EXPECT_GT(again.spread, 0.6);
  EXPECT_GT(again.depth_agreement, 0.95);
  EXPECT_GT(again.map_depth_agreement, 0.95);
  EXPECT_LT(again.rms_px, 2);
  EXPECT_TRUE(again.has_focal_scale);
  EXPECT_NEAR(again.focal_scale, 1, 0.01);
}

TEST_F(PoseSolverTest, HalfOfTheMatchesMayBeWrong) {
  observe(world_.frame(kIndex));
  const auto right = s_.search(truth_, 12);
  std::vector<Match> matches(right.begin(), right.end());
  testing::Random random(5);
  for (std::size_t i = 0; i < matches.size(); i += 2)
    matches[i].landmark = static_cast<std::int32_t>(random.below(world_.map().info().num_landmarks));
  const PoseEvidence found = s_.solve(matches);
  ASSERT_TRUE(found.is_found);
  EXPECT_LT(pose_error(truth_, found.T_map_camera).norm(), 0.03);
}

TEST_F(PoseSolverTest, WrongMatchesFitNothing) {
  observe(world_.frame(kIndex));
  std::vector<Match> matches;
  testing::Random random(5);
  for (std::int32_t i = 0; i < 200; ++i) {
    matches.push_back(
        {.feature = i, .landmark = static_cast<std::int32_t>(random.below(world_.map().info().num_landmarks)), .distance = 40});
  }
  const PoseEvidence found = s_.solve(matches);
  EXPECT_TRUE(!found.is_found || found.num_inliers < 20) << found.num_inliers;
  EXPECT_FALSE(s_.solve({}).is_found);
  EXPECT_FALSE(s_.solve(std::span(matches).first(3)).is_found);
}

TEST_F(PoseSolverTest, LookingFromTheWrongPlaceFindsNothing) {
  observe(world_.frame(kIndex));
  const PoseEvidence again = s_.refine(sample_pose(300));
  EXPECT_TRUE(!again.is_found || again.num_inliers < 15) << again.num_inliers;
}

TEST_F(PoseSolverTest, SpreadFallsWhereTheImageIsCovered) {
  FrameBuffer frame = world_.frame(kIndex);
  for (int y = 0; y < 240; ++y) std::fill(frame.gray.row(y) + (y < 60 ? 80 : 0), frame.gray.row(y) + 320, std::uint8_t{128});
  observe(frame);
  const PoseEvidence again = look_from_truth();
  ASSERT_TRUE(again.is_found);
  EXPECT_LE(again.spread, 6.0 / 48) << "a corner of two by two cells and what lies on its rim";
}

/// What lies behind the measured surface is hidden and says nothing; what the camera sees through speaks against the pose.
TEST_F(PoseSolverTest, MapDepthTellsHiddenFromSeenThrough) {
  observe(world_.frame(kIndex));
  const PoseEvidence plain = look_from_truth();
  FrameBuffer near = world_.frame(kIndex), far = near;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 160; ++x) {
      near.depth.at(x, y) = static_cast<std::uint16_t>(near.depth.at(x, y) / 2);
      far.depth.at(x, y) = static_cast<std::uint16_t>(far.depth.at(x, y) * 3 / 2);
    }
  }
  observe(near);
  const PoseEvidence hidden = look_from_truth();
  EXPECT_LT(hidden.num_map_depth, plain.num_map_depth * 3 / 4);
  EXPECT_GT(hidden.map_depth_agreement, 0.95);
  observe(far);
  const PoseEvidence seen_through = look_from_truth();
  EXPECT_GT(seen_through.num_map_depth, plain.num_map_depth * 9 / 10);
  EXPECT_LT(seen_through.map_depth_agreement, 0.75);
}

TEST_F(PoseSolverTest, MeasuresHowFlatTheEvidenceIs) {
  double flattest_m = 9, thickest_m = 0;
  for (std::uint64_t index = 0; index < testing::kMappedFrames; index += 6) {
    observe(world_.frame(index));
    const PoseEvidence room = s_.refine(sample_pose(index));
    ASSERT_TRUE(room.is_found) << index;
    EXPECT_GT(room.found_share(), 0.2) << index;
    flattest_m = std::min(flattest_m, room.thickness_m);
    thickest_m = std::max(thickest_m, room.thickness_m);
  }
  EXPECT_LT(flattest_m, 0.03) << "one wall";
  EXPECT_GT(thickest_m, 0.1) << "walls that meet";
  EXPECT_EQ(PoseEvidence{}.found_share(), 1) << "nothing is known";
}

TEST_F(PoseSolverTest, MeasuresTheFocalLength) {
  for (const double factor : {0.93, 1.08}) {
    RgbdCamera camera = world_.camera();
    camera.color.fx *= factor;
    camera.color.fy *= factor;
    camera.depth = camera.color;
    Solver solver(camera);
    solver.observe(world_.frame(kIndex));
    PoseEvidence found = solver.solve(solver.search(truth_, 40));
    ASSERT_TRUE(found.is_found);
    found = solver.refine(found.T_map_camera);
    ASSERT_TRUE(found.has_focal_scale);
    EXPECT_NEAR(found.focal_scale, 1 / factor, 0.01);
    EXPECT_LT(found.focal_scale_sigma, 0.02);
  }
}

}  // namespace
}  // namespace camloc
