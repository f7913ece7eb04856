// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A place is found in the whole map; where the map holds the place twice, nobody says which one it is.
#include "core/localize/global_search.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

/// The sample map with a second copy 20 m away of `percent` of its landmarks.
MapData with_twin(std::uint32_t percent) {
  return testing::with_copy({20, 0, 0}, [&](std::uint32_t landmark, const Eigen::Vector3d&) { return landmark * 37 % 100 < percent; });
}

struct Searched {
  GlobalSearchResult result;
  double error = 0;
};

Searched search(const MapView& map, std::uint64_t index) {
  const SampleWorld& world = SampleWorld::get();
  StageTimer timer(nullptr);
  FrameObservations observations(world.camera(), OrbOptions{}, true);
  PoseEstimator estimator(map, world.camera(), OrbOptions{}, PoseEstimatorOptions{}, &timer);
  GlobalSearch global(map, OrbOptions{}, GlobalSearchOptions{}, &timer);
  const FrameBuffer frame = world.frame(index);
  EXPECT_TRUE(observations.observe(frame.view()));
  const GlobalSearchResult result = global.search(observations, estimator, index);
  return {result, pose_error(sample_pose(index), result.best.T_map_camera).norm()};
}

TEST(GlobalSearch, FindsThePlace) {
  for (const std::uint64_t i : {1U, 31U, 61U, 89U}) {
    const auto [result, error] = search(SampleWorld::get().map(), i);
    EXPECT_TRUE(result.has_candidates);
    EXPECT_GE(result.num_places, 1);
    ASSERT_TRUE(result.best.is_found) << i;
    EXPECT_GT(result.best.num_inliers, 300U) << i;
    EXPECT_GT(result.margin, 0.8) << i;
    EXPECT_LT(error, 0.006) << i;
  }
}

TEST(GlobalSearch, MarginFallsWithALookAlike) {
  double last_margin = 1.2;
  for (const std::uint32_t percent : {0U, 30U, 60U, 100U}) {
    const testing::MapOnDisk map(with_twin(percent));
    ASSERT_NE(map.view, nullptr);
    double worst_margin = 1;
    for (const std::uint64_t i : {1U, 31U, 61U}) {
      const auto [result, error] = search(*map.view, i);
      ASSERT_TRUE(result.best.is_found);
      if (percent < 100) { EXPECT_LT(error, 0.01) << "the place with more of its landmarks wins"; }
      worst_margin = std::min(worst_margin, result.margin);
    }
    EXPECT_LT(worst_margin, last_margin - 0.1) << percent;
    last_margin = worst_margin;
  }
  EXPECT_LT(last_margin, 0.1);
}

TEST(GlobalSearch, TwinPlacesAreAmbiguous) {
  const SampleWorld& world = SampleWorld::get();
  const testing::MapOnDisk map(with_twin(100));
  ASSERT_NE(map.view, nullptr);
  for (const bool use_tracking : {false, true}) {
    Localizer localizer(*map.view, world.camera(), {.orb = {}, .use_tracking = use_tracking});
    for (std::uint64_t i = 1; i < testing::kMappedFrames; i += 9) {
      const FrameBuffer frame = world.frame(i);
      const Localization& result = localizer.process(frame.view());
      EXPECT_EQ(result.state, State::kCoarse) << i;
      EXPECT_EQ(result.reason, Reason::kAmbiguous) << i;
      EXPECT_GT(std::sqrt(result.covariance(0, 0)), 1) << "a candidate, no pose";
    }
  }
}

TEST(GlobalSearch, NoWordsNoCandidates) {
  const SampleWorld& world = SampleWorld::get();
  MapData data = world.data();
  data.words.clear();
  data.inverted_file.clear();
  const testing::MapOnDisk map(data);
  if (map.view == nullptr) GTEST_SKIP() << "a map without words is refused";
  Localizer localizer(*map.view, world.camera(), {});
  const FrameBuffer frame = world.frame(1);
  const Localization& result = localizer.process(frame.view());
  EXPECT_EQ(result.state, State::kLost);
  EXPECT_EQ(result.reason, Reason::kNoCandidates);
}

TEST(GlobalSearch, SeedChangesLittleAndSameSeedNothing) {
  const auto a = search(SampleWorld::get().map(), 40), b = search(SampleWorld::get().map(), 40);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.result.best.num_inliers, b.result.best.num_inliers);
  EXPECT_EQ(a.result.best.covariance, b.result.best.covariance);
}

}  // namespace
}  // namespace camloc
