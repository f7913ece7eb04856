// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a network says the camera is: asked when nothing else leads to a pose, off by decimetres, believed no more than a view that
// looks alike.
#include "core/localize/coarse_proposer.h"

#include <gtest/gtest.h>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

CoarseHint hint_at(const Rigid3& T_map_camera, std::int64_t stamp_ns, double off_m = 0.3) {
  CoarseHint hint{stamp_ns, T_map_camera, Matrix6d::Zero()};
  hint.T_map_camera.translation += Eigen::Vector3d(off_m, -0.5 * off_m, 0.2 * off_m);
  hint.T_map_camera.rotation = exp_so3({0.05, -0.1, 0.1}) * T_map_camera.rotation;
  hint.covariance.diagonal() << 0.1, 0.1, 0.1, 0.02, 0.02, 0.02;
  return hint;
}

/// Everything but retrieval: whatever is found without motion is the hint's.
std::vector<ProposerEntry> without_retrieval() {
  std::vector<ProposerEntry> table;
  for (const ProposerEntry& entry : proposer_table()) {
    if (std::string_view(entry.name) != "retrieval") table.push_back(entry);
  }
  return table;
}

struct Asked {
  LocalizerNumbers numbers;
  Gate gate{numbers, true};
  FrameFeatures view;
  CoarseProposer proposer{{&SampleWorld::get().map(), &SampleWorld::get().camera(), &numbers, 1000}};
  std::span<const Proposal> at(std::int64_t stamp_ns) { return proposer.propose({stamp_ns, &view, &gate}); }
};

TEST(CoarseProposer, ProposesWhatWasMappedAround) {
  Asked asked;
  EXPECT_TRUE(asked.at(0).empty());
  const Rigid3 truth = sample_pose(40);
  asked.proposer.on_coarse(hint_at(truth, 0));
  const auto places = asked.at(0);
  ASSERT_FALSE(places.empty());
  EXPECT_LE(places.size(), 3U);
  for (const std::uint32_t keyframe : places[0].places()) {
    const Rigid3 T_map_view = SampleWorld::get().map().keyframe_pose(keyframe);
    EXPECT_LT((T_map_view.translation - truth.translation).norm(), 1.5);
    EXPECT_LT(rotation_distance_rad(T_map_view.rotation, truth.rotation), 1.0);
  }
  EXPECT_FALSE(places[0].is_continuation);
  EXPECT_FALSE(places[0].overrides_motion) << "it is no person's word";
}

TEST(CoarseProposer, ForgetsWhatIsOldAndWhatLedToAPose) {
  Asked asked;
  asked.proposer.on_coarse(hint_at(sample_pose(40), 0));
  EXPECT_FALSE(asked.at(CoarseHint::kMaxAgeNs).empty());
  EXPECT_TRUE(asked.at(CoarseHint::kMaxAgeNs + 1).empty());
  asked.proposer.on_coarse(hint_at(sample_pose(40), 0));
  EXPECT_FALSE(asked.at(0).empty());
  asked.proposer.on_accepted();
  EXPECT_TRUE(asked.at(0).empty());
}

TEST(CoarseProposer, HasNothingToSayAboutWhereNothingWasMapped) {
  Asked asked;
  asked.proposer.on_coarse(hint_at(sample_pose(40), 0, 100));
  EXPECT_TRUE(asked.at(0).empty());
}

TEST(CoarseProposer, LeadsToAPoseWhereRetrievalDoesNot) {
  const SampleWorld& world = SampleWorld::get();
  const auto table = without_retrieval();
  Localizer localizer(world.map(), world.camera(), {}, table);
  EXPECT_EQ(localizer.process(world.frame(10).view()).state, State::kLost);
  localizer.coarse_hint(hint_at(sample_pose(10), 10 * testing::kFrameNs));
  const Localization& result = localizer.process(world.frame(11).view());
  ASSERT_EQ(result.state, State::kLocalized);
  EXPECT_STREQ(result.proposed_by, "coarse");
  EXPECT_LT(pose_error(sample_pose(11), result.T_map_camera).norm(), 0.02);
  EXPECT_STREQ(localizer.process(world.frame(12).view()).proposed_by, "motion");
}

TEST(CoarseProposer, IsNotAskedWhereOthersAreEnoughAndAWrongOneDoesNoHarm) {
  const SampleWorld& world = SampleWorld::get();
  Localizer with(world.map(), world.camera(), {}), without(world.map(), world.camera(), {});
  for (std::uint64_t i = 1; i < 20; i += 3) {
    with.coarse_hint(hint_at(sample_pose(80 - i), static_cast<std::int64_t>(i) * testing::kFrameNs));
    const FrameBuffer frame = world.frame(i);
    EXPECT_EQ(testing::bits_of(with.process(frame.view())), testing::bits_of(without.process(frame.view())));
  }
}

TEST(CoarseProposer, DoesNotDecideBetweenRoomsThatLookAlike) {
  const SampleWorld& world = SampleWorld::get();
  const testing::MapOnDisk twins(testing::with_copy({20, 0, 0}, [](std::uint32_t, const Eigen::Vector3d&) { return true; }));
  Localizer localizer(*twins.view, world.camera(), {});
  for (std::uint64_t i = 10; i < 13; ++i) {
    Rigid3 wrong = sample_pose(i);
    wrong.translation.x() += 20;
    localizer.coarse_hint(hint_at(wrong, static_cast<std::int64_t>(i) * testing::kFrameNs));
    const Localization& result = localizer.process(world.frame(i).view());
    EXPECT_NE(result.state, State::kLocalized);
    EXPECT_EQ(result.reason, Reason::kAmbiguous);
  }
}

TEST(CoarseProposer, IsTheCoarsePoseWhereNothingLooksAlike) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {});
  FrameBuffer frame = world.frame(10);
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), std::uint8_t{90});
  const CoarseHint hint = hint_at(sample_pose(10), frame.stamp_ns - 500'000'000);
  localizer.coarse_hint(hint);
  const Localization& result = localizer.process(frame.view());
  EXPECT_EQ(result.state, State::kCoarse);
  ASSERT_TRUE(result.has_pose);
  EXPECT_EQ(result.T_map_camera.translation, hint.T_map_camera.translation);
  EXPECT_GE(result.covariance(0, 0), 0.1 + 0.25) << "half a second old";
  EXPECT_EQ(result.integrity_risk, 1);
  frame.stamp_ns += 2'000'000'000;
  EXPECT_EQ(localizer.process(frame.view()).state, State::kLost);
}

TEST(CoarseProposer, NonsenseIsIgnored) {
  const SampleWorld& world = SampleWorld::get();
  const auto table = without_retrieval();
  Localizer localizer(world.map(), world.camera(), {}, table);
  const CoarseHint good = hint_at(sample_pose(10), 10 * testing::kFrameNs);
  for (const int what : {0, 1, 2, 3}) {
    CoarseHint bad = good;
    if (what == 0) bad.T_map_camera.translation.x() = NAN;
    if (what == 1) bad.T_map_camera.rotation.coeffs() *= 2;
    if (what == 2) bad.covariance(0, 0) = INFINITY;
    if (what == 3) bad.covariance.setZero();
    localizer.coarse_hint(bad);
    EXPECT_EQ(localizer.process(world.frame(10).view()).state, State::kLost) << what;
  }
}

}  // namespace
}  // namespace camloc
