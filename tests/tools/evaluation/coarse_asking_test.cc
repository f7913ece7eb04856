// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/coarse_asking.h"

#include "tests/drivers/test_folder.h"
#include "tests/tools/coarse_model_file.h"

namespace camloc::tools {
namespace {

using camloc::testing::SampleWorld;

/// Without retrieval, so that what is found is the network's.
std::vector<ProposerEntry> without_retrieval() {
  std::vector<ProposerEntry> table;
  for (const ProposerEntry& entry : proposer_table()) {
    if (std::string_view(entry.name) != "retrieval") table.push_back(entry);
  }
  return table;
}

TEST(CoarseAsking, AnswersWithTheNextFrameOrAtOnceForASingleOne) {
  if (!kHasPlugin) GTEST_SKIP() << "the plug-in is not built";
  use_built_plugin();
  const TestFolder folder;
  const SampleWorld& world = SampleWorld::get();
  write_constant_model(folder / "a.onnx", sample_pose(10));
  auto asking = CoarseAsking::open(folder / "a.onnx", world.map(), world.camera());
  ASSERT_TRUE(asking) << asking.status().message();
  const auto table = without_retrieval();
  Localizer localizer(world.map(), world.camera(), {}, table), other(world.map(), world.camera(), {}, table);
  EXPECT_EQ((*asking)->process(world.frame(10).view(), &localizer).state, State::kLost);
  const Localization& result = (*asking)->process(world.frame(11).view(), &localizer);
  EXPECT_EQ(result.state, State::kLocalized);
  EXPECT_STREQ(result.proposed_by, "coarse");
  EXPECT_EQ((*asking)->process_single(world.frame(10).view(), &other).state, State::kLocalized);
}

TEST(CoarseAsking, RefusesAModelOfAnotherMap) {
  const TestFolder folder;
  const SampleWorld& world = SampleWorld::get();
  write_constant_model(folder / "a.onnx", sample_pose(10), 77);
  const auto asking = CoarseAsking::open(folder / "a.onnx", world.map(), world.camera());
  EXPECT_NE(asking.status().message().find("000000000000004d"), std::string::npos);
}

}  // namespace
}  // namespace camloc::tools
