// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/coarse_evaluation.h"

#include "tests/drivers/test_folder.h"
#include "tests/tools/coarse_model_file.h"

namespace camloc::tools {
namespace {

using camloc::testing::SampleWorld;

TEST(CoarseEvaluation, RetrievalDecidesUnlessItIsWeak) {
  const MapView& map = SampleWorld::get().map();
  CoarsePose cnn;
  cnn.T_map_camera = map.keyframe_pose(0);
  cnn.T_map_camera.translation.x() += 2;
  EXPECT_EQ(merge_coarse(cnn, {0, 0.6F}, map).translation, map.keyframe_pose(0).translation);
  const Eigen::Vector3d middle = map.keyframe_pose(0).translation + Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((merge_coarse(cnn, {0, 0.1F}, map).translation - middle).norm(), 1e-9);
}

TEST(CoarseEvaluation, JudgesEachByTheTruth) {
  if (!kHasPlugin) GTEST_SKIP() << "the plug-in is not built";
  use_built_plugin();
  const TestFolder folder;
  const SampleWorld& world = SampleWorld::get();
  Rigid3 said = sample_pose(1);
  said.translation.z() += 0.5;
  write_constant_model(folder / "a.onnx", said);
  const auto model = read_coarse_model(folder / "a.onnx");
  ASSERT_TRUE(model) << model.status().message();
  auto network = CoarseNetwork::load(*model, world.camera());
  ASSERT_TRUE(network) << network.status().message();
  CoarseEvaluation evaluation(world.map(), world.camera(), std::move(*network));
  for (int i = 0; i < 3; ++i) evaluation.add(world.frame(1).view(), sample_pose(1));
  const CoarseReport report = evaluation.report();
  EXPECT_EQ(report.num_frames, 3U);
  EXPECT_EQ(report.cnn.num_answers, 3U);
  EXPECT_NEAR(report.cnn.translation_m.median, 0.5, 1e-5);
  EXPECT_NEAR(report.cnn.translation_m.max, 0.5, 1e-5);
  EXPECT_NEAR(report.cnn.rotation_deg.mean, 0, 0.01);
  EXPECT_NEAR(report.nees_median, 4, 0.01) << "two standard deviations of 0.25 m";
  EXPECT_EQ(report.retrieval.num_answers, 3U);
  EXPECT_LT(report.retrieval.translation_m.mean, 0.5);
  EXPECT_EQ(report.both.translation_m.mean, report.retrieval.translation_m.mean) << "the sample room's views are no weak ones";
  EXPECT_GT(report.locate_p50_ms, 0);
}

}  // namespace
}  // namespace camloc::tools
