// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The picture is written, shows what was drawn, and survives odd input.
#include "tools/evaluation/top_view.h"

#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

Rigid3 at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

TEST(TopViewTest, DrawsTruthAndEstimate) {
  const TemporaryFolder folder;
  TopView view;
  for (int i = 0; i < 20; ++i) view.truth.push_back(at(0.2 * i, 0.1 * i, 0));
  ASSERT_TRUE(write_top_view(view, folder / "truth.png").is_ok());
  view.estimate = {at(1, 1, 0), at(2, 0.5, 0)};
  view.error_m = {0.01, 0.4};
  ASSERT_TRUE(write_top_view(view, folder / "both.png").is_ok());
  EXPECT_GT(std::filesystem::file_size(folder / "both.png"), 1000U);
  std::ifstream truth(folder / "truth.png", std::ios::binary), both(folder / "both.png", std::ios::binary);
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(truth), {}), std::string(std::istreambuf_iterator<char>(both), {}));
}

TEST(TopViewTest, NothingOrASinglePointIsStillAPicture) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_top_view({}, folder / "empty.png").is_ok());
  TopView point;
  point.truth = point.estimate = {at(1e6, -3, 2)};
  EXPECT_TRUE(write_top_view(point, folder / "point.png").is_ok());
}

TEST(TopViewTest, AFailedWriteIsAnError) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_top_view({}, folder / "no/x.png").code(), ErrorCode::kIo);
}

}  // namespace
}  // namespace camloc::tools
