// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A generated room whose poses are given in another convention.
#include "tools/mapping/build/pose_check.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"
#include "tests/mapping/recorded_room.h"

namespace camloc::mapping {
namespace {

constexpr std::uint64_t kFrames = 45;

Result<PoseVerdict> verdict_of(const TestFolder& folder, const std::function<Rigid3(const Rigid3&)>& given, PosedFramesRequest* request) {
  std::string text;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    text += format_tum_line(100'000'000'000 + static_cast<std::int64_t>(static_cast<double>(i) * 1e9 / 15), given(room_pose(i))) + "\n";
  }
  request->sequence = folder / "walk 50%20";
  request->poses = folder.write("poses.tum", text);
  const auto frames = find_posed_frames(*request, room_camera());
  if (!frames.is_ok()) return frames.status();
  return check_poses(*request, frames.value(), room_camera(), OrbOptions{}, WorkObserver::nobody());
}

TEST(PoseCheck, BelievesRightPosesAndNoOthers) {
  const TestFolder folder;
  record_room(folder / "walk 50%20", kFrames);
  PosedFramesRequest request;
  const auto right = verdict_of(
      folder, [](const Rigid3& T) { return T; }, &request);
  ASSERT_TRUE(right.is_ok()) << right.status().message();
  ASSERT_GE(right->num_motions, PoseVerdict::kMinMotions);
  EXPECT_FALSE(right->is_contradicted()) << right->given.score;
  const auto inverted = verdict_of(
      folder, [](const Rigid3& T) { return T.inverse(); }, &request);
  ASSERT_TRUE(inverted.is_ok()) << inverted.status().message();
  EXPECT_TRUE(inverted->is_contradicted()) << inverted->given.score;
  const std::string text = describe_contradiction(*inverted, "poses.tum");
  EXPECT_TRUE(text.starts_with("poses.tum: the poses contradict the images: in ")) << text;
  EXPECT_NE(text.find("inverted"), std::string::npos) << text;
}

TEST(PoseCheck, SaysWhereNoReadingFits) {
  PoseVerdict verdict;
  verdict.num_motions = 20;
  verdict.given = {0.5, 0.2, 9};
  const std::string text = describe_contradiction(verdict, "p");
  EXPECT_NE(text.find("off by 50.0 cm and 11.5 deg"), std::string::npos) << text;
  EXPECT_NE(text.find("No other reading of them fits"), std::string::npos) << text;
}

}  // namespace
}  // namespace camloc::mapping
