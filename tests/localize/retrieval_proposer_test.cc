// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A place is found in the whole map; where the map holds the place twice, nobody says which one it is.
#include "core/localize/retrieval_proposer.h"

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
  Localization result;
  double error = 0;
};

Searched search(const MapView& map, std::uint64_t index) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(map, world.camera(), {.orb = {}, .use_tracking = false});
  const FrameBuffer frame = world.frame(index);
  const Localization& result = localizer.process(frame.view());
  return {result, pose_error(sample_pose(index), result.evidence.T_map_camera).norm()};
}

TEST(RetrievalProposer, ProposesViewsOfThePlace) {
  const SampleWorld& world = SampleWorld::get();
  const LocalizerNumbers numbers;
  RetrievalProposer proposer({&world.map(), &world.camera(), &numbers, 1000});
  FrameExtractor extractor(world.camera(), OrbOptions{});
  const Gate gate(numbers, true);
  for (const std::uint64_t i : {1U, 31U, 61U, 89U}) {
    FrameFeatures view;
    const FrameBuffer frame = world.frame(i);
    extractor.extract(frame.view(), &view);
    const auto proposals = proposer.propose({0, &view, &gate});
    ASSERT_FALSE(proposals.empty());
    EXPECT_LE(proposals.size(), static_cast<std::size_t>(numbers.max_places));
    for (const Proposal& proposal : proposals) {
      EXPECT_GT(proposal.num_keyframes, 0);
      EXPECT_LE(proposal.num_keyframes, numbers.max_keyframes_per_place);
      EXPECT_FALSE(proposal.is_continuation || proposal.overrides_motion);
      const Rigid3 first = world.map().keyframe_pose(proposal.places().front());
      for (const std::uint32_t k : proposal.places())
        EXPECT_LT((world.map().keyframe_pose(k).translation - first.translation).norm(), numbers.place_radius_m);
    }
    const Rigid3 nearest = world.map().keyframe_pose(proposals[0].places().front());
    EXPECT_LT((nearest.translation - sample_pose(i).translation).norm(), 1.0) << i;
  }
}

TEST(RetrievalProposer, FindsThePlace) {
  for (const std::uint64_t i : {1U, 31U, 61U, 89U}) {
    const auto [result, error] = search(SampleWorld::get().map(), i);
    ASSERT_TRUE(result.evidence.is_found) << i;
    EXPECT_GT(result.evidence.num_inliers, 300U) << i;
    EXPECT_GT(result.standing.margin, 0.8) << i;
    EXPECT_LT(error, 0.006) << i;
  }
}

TEST(RetrievalProposer, MarginFallsWithALookAlike) {
  double last_margin = 1.2;
  for (const std::uint32_t percent : {0U, 30U, 60U, 100U}) {
    const testing::MapOnDisk map(with_twin(percent));
    ASSERT_NE(map.view, nullptr);
    double worst_margin = 1;
    for (const std::uint64_t i : {1U, 31U, 61U}) {
      const auto [result, error] = search(*map.view, i);
      ASSERT_TRUE(result.evidence.is_found);
      if (percent < 100) { EXPECT_LT(error, 0.01) << "the place with more of its landmarks wins"; }
      worst_margin = std::min(worst_margin, result.standing.margin);
    }
    EXPECT_LT(worst_margin, last_margin - 0.1) << percent;
    last_margin = worst_margin;
  }
  EXPECT_LT(last_margin, 0.1);
}

TEST(RetrievalProposer, TwinPlacesAreAmbiguous) {
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

TEST(RetrievalProposer, SameSeedSameBits) {
  const auto a = search(SampleWorld::get().map(), 40), b = search(SampleWorld::get().map(), 40);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.result.evidence.num_inliers, b.result.evidence.num_inliers);
  EXPECT_EQ(a.result.covariance, b.result.covariance);
}

}  // namespace
}  // namespace camloc
