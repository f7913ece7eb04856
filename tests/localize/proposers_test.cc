// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A proposer of one's own is a class and a line in a table: nothing else of the localizer knows it.
#include <gtest/gtest.h>

#include <vector>

#include "core/localize/proposer.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

int num_asked = 0, num_accepted = 0;

/// A marker on the wall, say: knows the pose up to a few centimetres.
class MarkerProposer final : public Proposer {
 public:
  explicit MarkerProposer(const ProposerContext&) {}
  [[nodiscard]] std::span<const Proposal> propose(const ProposerInput& input) override {
    ++num_asked;
    proposal_.T_map_camera = sample_pose(static_cast<std::uint64_t>(input.stamp_ns / testing::kFrameNs));
    proposal_.T_map_camera.translation.z() += 0.03;
    proposal_.radius_px = 25;
    return {&proposal_, 1};
  }
  void on_accepted() override { ++num_accepted; }

 private:
  Proposal proposal_;
};

std::unique_ptr<Proposer> make_marker(const ProposerContext& context) { return std::make_unique<MarkerProposer>(context); }

TEST(Proposers, OneMoreIsOneLineInATable) {
  const SampleWorld& world = SampleWorld::get();
  const LocalizerOptions options;
  const ProposerEntry only_marker[] = {{"marker", make_marker}};
  Localizer localizer(world.map(), world.camera(), options, only_marker);
  num_asked = num_accepted = 0;
  for (std::uint64_t i = 1; i < 20; i += 3) {
    const FrameBuffer frame = world.frame(i);
    const Localization& result = localizer.process(frame.view());
    EXPECT_EQ(result.state, State::kLocalized) << i;
    EXPECT_LT(pose_error(sample_pose(i), result.T_map_camera).norm(), 0.02);
  }
  EXPECT_EQ(num_asked, 7);
  EXPECT_EQ(num_accepted, 7);
}

TEST(Proposers, ComeAfterEachOtherUntilOneIsBelieved) {
  const SampleWorld& world = SampleWorld::get();
  std::vector<ProposerEntry> table(proposer_table().begin(), proposer_table().end());
  table.push_back({"marker", make_marker});
  Localizer localizer(world.map(), world.camera(), {}, table);
  num_asked = 0;
  for (std::uint64_t i = 1; i < 20; i += 3) EXPECT_EQ(localizer.process(world.frame(i).view()).state, State::kLocalized);
  EXPECT_EQ(num_asked, 0) << "the others were enough";
}

TEST(Proposers, WithoutAnyTheCameraIsLost) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {}, std::span<const ProposerEntry>{});
  EXPECT_EQ(localizer.process(world.frame(1).view()).state, State::kLost);
}

TEST(Proposers, TheTableIsCheapestFirst) {
  std::vector<std::string> names;
  for (const ProposerEntry& entry : proposer_table()) names.emplace_back(entry.name);
  EXPECT_EQ(names, (std::vector<std::string>{"hint", "motion", "retrieval", "coarse"}));
}

}  // namespace
}  // namespace camloc
