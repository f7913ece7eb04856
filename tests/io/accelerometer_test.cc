// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

TEST(Accelerometer, ReadsTumFiles) {
  const TestFolder folder;
  const auto samples = read_accelerometer(folder.write("accelerometer.txt",
                                                       "# accelerometer data\n# timestamp ax ay az\n1305031098.664900 -0.07 9.32 -2.97\r\n"
                                                       "1305031098.666885 0.1 9.5 -2.5\n"));
  ASSERT_TRUE(samples.is_ok()) << samples.status().message();
  ASSERT_EQ(samples->size(), 2U);
  EXPECT_EQ((*samples)[0].stamp_ns, 1305031098664900000);
  EXPECT_EQ((*samples)[0].acceleration, Eigen::Vector3d(-0.07, 9.32, -2.97));
}

TEST(Accelerometer, MultiplesOfGravityBecomeMetres) {
  const TestFolder folder;
  const auto samples = read_accelerometer(folder.write("a.txt", "1 0 1 0\n2 0.1 0.99 0\n3 0 1.6 0\n"));
  ASSERT_TRUE(samples.is_ok());
  EXPECT_NEAR((*samples)[0].acceleration.y(), kStandardGravity, 1e-12);
}

TEST(Accelerometer, ErrorsNameFileAndLine) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"", "a.txt: no reading"},
      {"1 0 9.8\n", "a.txt:1: 3 fields"},
      {"1 0 9.8 0\nx 0 9.8 0\n", "a.txt:2: stamp 'x'"},
      {"1 0 nan 0\n", "'nan' is not an acceleration"},
      {"1 0 inf 0\n", "'inf' is not an acceleration"},
      {"1 0 y 0\n", "'y' is not an acceleration"},
      {"2 0 9.8 0\n1 0 9.8 0\n", "a.txt:2: stamp is before"},
      {"1 3 819 -5\n", "typical length 819"},
      {"1 0 0 0\n", "typical length 0"},
  };
  const TestFolder folder;
  for (const auto& one : cases) {
    const auto samples = read_accelerometer(folder.write("a.txt", one.text));
    ASSERT_FALSE(samples.is_ok()) << one.text;
    EXPECT_NE(samples.status().message().find(one.part), std::string::npos) << samples.status().message();
  }
  EXPECT_EQ(read_accelerometer("/nowhere/a.txt").status().code(), ErrorCode::kNotFound);
}

TEST(Accelerometer, OrientationsAreThoseOfTheTrajectory) {
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ()));
  const std::vector<StampedPose> trajectory = {{1'000'000'000, {}}, {1'100'000'000, {quarter, {0, 0, 0}}}};
  const std::vector<AccelerometerSample> samples = {
      {900'000'000, {0, 9.8, 0}}, {1'000'000'000, {0, 9.8, 0}}, {1'050'000'000, {1, 9.8, 0}}, {2'000'000'000, {0, 9.8, 0}}};
  const std::vector<OrientedReading> readings = with_orientations(samples, trajectory);
  ASSERT_EQ(readings.size(), 2U);
  EXPECT_NEAR(rotation_distance_rad(readings[1].R_map_camera, Eigen::Quaterniond::Identity()), 0.75, 1e-9);
  EXPECT_EQ(readings[1].acceleration.x(), 1);
}

}  // namespace
}  // namespace camloc
