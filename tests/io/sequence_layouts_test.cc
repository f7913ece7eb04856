// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"
#include "tests/io/sequence_checks.h"

namespace camloc {
namespace {

TEST(SequenceLayouts, AssociationsInEitherOrder) {
  const TestFolder folder;
  touch(folder, {"c/1.png", "c/2.png", "my depth/1.png", "depth/1.png", "depth/2.png"});
  folder.write("associations.txt",
               "# ORB-SLAM\n1.0 c/1.png 1.05 depth/1.png\n1.1 c/2.png 1.15 depth/2.png\n1.1 c/2.png 1.15 depth/2.png\n");
  const auto color_first = read_sequence(folder.path());
  ASSERT_TRUE(color_first.is_ok()) << color_first.status().message();
  EXPECT_EQ(color_first->layout, "tum");
  ASSERT_EQ(color_first->frames.size(), 2U);
  EXPECT_EQ(color_first->frames[1].stamp_ns, 1'100'000'000);
  EXPECT_EQ(color_first->frames[1].color_path, folder / "c/2.png");
  EXPECT_EQ(color_first->frames[1].depth_path, folder / "depth/2.png") << "taken as written, however far apart";
  ASSERT_EQ(color_first->notes.size(), 1U);
  folder.write("associations.txt", "1.05 depth/1.png 1.0 c/1.png\n");
  const auto depth_first = read_sequence(folder.path());
  ASSERT_TRUE(depth_first.is_ok()) << depth_first.status().message();
  EXPECT_EQ(depth_first->frames[0].color_path, folder / "c/1.png");
  EXPECT_EQ(depth_first->frames[0].stamp_ns, 1'000'000'000);
  for (const auto& [text, part] : {std::pair{"1 c/1.png 1 c/2.png\n", "associations.txt:1: which is the depth image?"},
                                   {"1 c/1.png 1 none\n", "associations.txt:1: image 'none' does not exist"},
                                   {"1 c/1.png\n", "associations.txt:1: 2 fields"}}) {
    folder.write("associations.txt", text);
    expect_error(read_sequence(folder.path()), ErrorCode::kInvalid, part);
  }
}

TEST(SequenceLayouts, AssociationsTellDepthByItsBits) {
  const TestFolder folder;
  const std::string head("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1", 24);
  folder.write("depthlike.png", head + std::string("\x08\x02", 2));
  folder.write("b.png", head + std::string("\x10\0", 2));
  folder.write("associations.txt", "0 depthlike.png 0 b.png\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_EQ(sequence->frames[0].depth_path, folder / "b.png");
}

TEST(SequenceLayouts, ScanNetInOrderOfNumbers) {
  const TestFolder folder;
  touch(folder, {"color/0.jpg", "color/10.jpg", "color/2.jpg", "depth/0.png", "depth/10.png"});
  folder.write("pose/2.txt", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  folder.write("pose/10.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_EQ(sequence->layout, "scannet");
  ASSERT_EQ(sequence->frames.size(), 3U);
  EXPECT_EQ(sequence->frames[1].color_path, folder / "color/2.jpg");
  EXPECT_EQ(sequence->frames[1].depth_path, "");
  EXPECT_EQ(sequence->frames[2].stamp_ns, 333'333'333);
  EXPECT_EQ(sequence->frames[2].depth_path, folder / "depth/10.png");
  const auto poses = read_embedded_poses(*sequence);
  ASSERT_TRUE(poses.is_ok()) << poses.status().message();
  EXPECT_FALSE((*poses)[0]);
  EXPECT_EQ((*poses)[1]->translation.x(), 5);
  EXPECT_FALSE((*poses)[2]);
}

}  // namespace
}  // namespace camloc
