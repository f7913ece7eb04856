// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/io/sequence.h"
#include "core/io/text.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

Rigid3 turn_z(double angle_rad, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ())), translation};
}

void expect_near(const Rigid3& a, const Rigid3& b, double tolerance) {
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
  EXPECT_LT(rotation_distance_rad(a.rotation, b.rotation), tolerance);
}

TEST(Trajectory, LineHasEightFieldsAndNoTrailingSpace) {
  const std::string line = format_tum_line(1305031229528748001, turn_z(0.5, {1, -2, 3e-7}));
  EXPECT_EQ(split_fields(line, " ").size(), 8U);
  EXPECT_EQ(line.find("  "), std::string::npos);
  EXPECT_NE(line.back(), ' ');
  EXPECT_TRUE(line.starts_with("1305031229.528748001 1.000000000 -2.000000000 0.000000300 0.000000000 ")) << line;
  EXPECT_TRUE(format_tum_line(5, {}).starts_with("0.000000005 "));
  EXPECT_TRUE(format_tum_line(-1500000000, {}).starts_with("-1.500000000 "));
}

TEST(Trajectory, WrittenLinesReadBack) {
  const TestFolder folder;
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  std::vector<Rigid3> poses;
  for (int i = 0; i < 20; ++i) {
    poses.push_back(turn_z(0.3 * i, {0.1 * i, -1.0 * i, 7}));
    text += format_tum_line(1305031229000000001 + i * 33333333LL, poses.back()) + "\r\n";
  }
  const auto read = read_tum_trajectory(folder.write("t.tum", text));
  ASSERT_TRUE(read.is_ok()) << read.status().message();
  ASSERT_EQ(read->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ((*read)[i].stamp_ns, 1305031229000000001 + static_cast<std::int64_t>(i) * 33333333);
    expect_near((*read)[i].T_world_camera, poses[i], 1e-8);
    EXPECT_NEAR((*read)[i].T_world_camera.rotation.norm(), 1, 1e-15);
  }
}

TEST(Trajectory, BadLinesNameFileAndLine) {
  const TestFolder folder;
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n", "t.tum:2: 7 fields"},
      {"1 0 0 0 0 0 0 1 2\n", "t.tum:1: 9 fields"},
      {"x 0 0 0 0 0 0 1\n", "t.tum:1: stamp 'x'"},
      {"1 0 0 y 0 0 0 1\n", "'y' is not a number"},
      {"1 0 0 nan 0 0 0 1\n", "t.tum:1: no pose (nan"},
      {"1 0 0 0 0 0 0 0\n", "t.tum:1: no pose"},
      {"1 0 0 0 0 0 0 2\n", "unit length"},
      {"2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "t.tum:2: stamp is before"},
  };
  for (const auto& one : cases) {
    const auto result = read_tum_trajectory(folder.write("t.tum", one.text));
    ASSERT_FALSE(result.is_ok()) << one.text;
    EXPECT_NE(result.status().message().find(one.part), std::string::npos) << result.status().message();
  }
  EXPECT_EQ(read_tum_trajectory(folder / "none").status().code(), ErrorCode::kNotFound);
}

TEST(Trajectory, LinesWithoutAPoseAreLeftOutCountedAndNamed) {
  const TestFolder folder;
  for (const char* bad :
       {"nan nan nan nan nan nan nan", "0 0 0 0 0 0 0", "-1.#INF 0 0 0 0 0 1", "1 -inf 3 0 0 0 1", "1 2 3 -nan(ind) 0 0 1"}) {
    SCOPED_TRACE(bad);
    std::vector<std::string> notes;
    const auto poses = read_tum_trajectory(
        folder.write("t.tum", "# motion capture\n1.0 1 0 0 0 0 0 1\n1.1 " + std::string(bad) + "\n1.2 " + bad + "\n1.3 4 0 0 0 0 0 1\n"),
        &notes);
    ASSERT_TRUE(poses.is_ok()) << poses.status().message();
    ASSERT_EQ(poses->size(), 2U);
    EXPECT_EQ((*poses)[1].T_world_camera.translation.x(), 4);
    EXPECT_FALSE(pose_at(*poses, 1'150'000'000)) << "in the gap there is no pose";
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("t.tum: 2 lines left out"), std::string::npos) << notes[0];
    EXPECT_NE(notes[0].find("the first in line 3"), std::string::npos) << notes[0];
  }
}

TEST(Trajectory, PoseAtInterpolatesOverShortGapsOnly) {
  const std::vector<StampedPose> trajectory{
      {1'000'000'000, turn_z(0, {0, 0, 0})}, {1'100'000'000, turn_z(0.2, {1, 0, 0})}, {2'000'000'000, turn_z(1, {5, 0, 0})}};
  expect_near(*pose_at(trajectory, 1'000'000'000), trajectory[0].T_world_camera, 1e-12);
  expect_near(*pose_at(trajectory, 1'025'000'000), turn_z(0.05, {0.25, 0, 0}), 1e-9);
  EXPECT_FALSE(pose_at(trajectory, 1'500'000'000));
  expect_near(*pose_at(trajectory, 1'100'400'000), trajectory[1].T_world_camera, 1e-12);
  expect_near(*pose_at(trajectory, 1'999'600'000), trajectory[2].T_world_camera, 1e-12);
  expect_near(*pose_at(trajectory, 2'000'500'000), trajectory[2].T_world_camera, 1e-12);
  EXPECT_FALSE(pose_at(trajectory, 2'000'600'000));
  EXPECT_TRUE(pose_at(trajectory, 999'600'000));
  EXPECT_FALSE(pose_at(trajectory, 999'000'000));
  EXPECT_FALSE(pose_at({}, 0));
}

TEST(Trajectory, EmbeddedTumPosesAreAtTheColorStamps) {
  const TestFolder folder;
  for (const char* name : {"a", "b", "c"}) folder.write(name, "x");
  folder.write("rgb.txt", "1.05 a\n1.50 b\n3.0 c\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok());
  const auto missing = read_embedded_poses(*sequence);
  EXPECT_EQ(missing.status().code(), ErrorCode::kNotFound);
  EXPECT_NE(missing.status().message().find("groundtruth.txt"), std::string::npos);
  folder.write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n1.1 1 0 0 0 0 0 1\n1.45 0 0 0 0 0 0 1\n1.55 0 2 0 0 0 0 1\n");
  const auto poses = read_embedded_poses(*sequence);
  ASSERT_TRUE(poses.is_ok());
  ASSERT_EQ(poses->size(), 3U);
  EXPECT_NEAR((*poses)[0]->translation.x(), 0.5, 1e-6);
  EXPECT_NEAR((*poses)[1]->translation.y(), 1.0, 1e-6);
  EXPECT_FALSE((*poses)[2]);
}

TEST(Trajectory, SevenScenesPosesBecomeRotations) {
  const TestFolder folder;
  for (const char* name : {"frame-000000.color.png", "frame-000001.color.png", "frame-000002.color.png"}) folder.write(name, "x");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok());
  EXPECT_EQ(read_embedded_poses(*sequence).status().code(), ErrorCode::kNotFound);
  // A quarter turn about z, a little stretched as in the dataset.
  folder.write("frame-000000.pose.txt", "0\t-1.0004\t0\t1\n1.0004\t0\t0\t2\n0\t0\t0.9996\t3\n0\t0\t0\t1\t\n");
  folder.write("frame-000002.pose.txt", "-1.#IND nan nan nan nan nan nan nan nan nan nan nan 0 0 0 1");
  ASSERT_TRUE(read_embedded_poses(*sequence).is_ok());
  EXPECT_FALSE((*read_embedded_poses(*sequence))[2]) << "a frame without a pose, in Windows' spelling";
  folder.write("frame-000002.pose.txt", "nan nan nan inf nan nan nan nan nan nan nan nan 0 0 0 1");
  const auto poses = read_embedded_poses(*sequence);
  ASSERT_TRUE(poses.is_ok()) << poses.status().message();
  expect_near((*poses)[0].value(), turn_z(M_PI / 2, {1, 2, 3}), 1e-9);
  EXPECT_FALSE((*poses)[1]);
  EXPECT_FALSE((*poses)[2]);
}

TEST(Trajectory, BadPoseFiles) {
  const TestFolder folder;
  folder.write("frame-000000.color.png", "x");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok());
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"1 0 0", "3 numbers"},
      {"", "0 numbers"},
      {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 x", "'x' is not a number"},
      {"2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1", "not a rigid transform"},
      {"-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "not a rigid transform"},
      {"1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1", "not a rigid transform"},
  };
  for (const auto& one : cases) {
    folder.write("frame-000000.pose.txt", one.text);
    const auto poses = read_embedded_poses(*sequence);
    ASSERT_FALSE(poses.is_ok()) << one.text;
    EXPECT_NE(poses.status().message().find(one.part), std::string::npos) << poses.status().message();
    EXPECT_NE(poses.status().message().find("frame-000000.pose.txt"), std::string::npos);
  }
}

}  // namespace
}  // namespace camloc
