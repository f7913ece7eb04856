// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "tests/base/recording_observer.h"

namespace camloc::mapping {
namespace {

const std::vector<Eigen::Vector3d> kPoints = {{1.5, -2.25, 0.5}, {2, 4, 8}, {-3.125, 0, 1}};

template <typename T>
void put(std::string* bytes, T value, bool is_big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (is_big_endian) std::reverse(raw, raw + sizeof(T));
  bytes->append(raw, sizeof(T));
}

template <typename T>
void put_at(std::string* bytes, std::size_t offset, T value) {
  std::memcpy(bytes->data() + offset, &value, sizeof(T));
}

Result<PointCloud> read(const std::string& bytes, const std::string& name, const CloudOptions& options = {}) {
  std::istringstream stream(bytes);
  return read_cloud(stream, name, options);
}

/// The points are there, in any order, to `tolerance_m`.
void expect_points(const Result<PointCloud>& cloud, std::vector<Eigen::Vector3d> points, double tolerance_m = 1e-6) {
  ASSERT_TRUE(cloud.is_ok()) << cloud.status().message();
  ASSERT_EQ(cloud.value().points_m.size(), points.size());
  for (const Eigen::Vector3d& expected : points) {
    double nearest = 1e9;
    for (const Eigen::Vector3f& p : cloud.value().points_m)
      nearest = std::min(nearest, (cloud.value().origin_m + p.cast<double>() - expected).norm());
    EXPECT_LT(nearest, tolerance_m) << expected.transpose();
  }
}

void expect_error(const Result<PointCloud>& cloud, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(cloud.is_ok());
  EXPECT_EQ(cloud.status().code(), code) << cloud.status().message();
  EXPECT_NE(cloud.status().message().find(part), std::string::npos) << cloud.status().message();
  EXPECT_EQ(cloud.status().message().find('\n'), std::string::npos);
}

std::string binary_ply(bool is_big_endian, std::uint64_t count = 3) {
  std::string bytes =
      std::string("ply\nformat ") + (is_big_endian ? "binary_big_endian" : "binary_little_endian") +
      " 1.0\ncomment made by hand\nelement camera 1\nproperty list uchar int ids\nproperty float f\nelement vertex " +
      std::to_string(count) +
      "\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  put<std::uint8_t>(&bytes, 2);
  put<std::int32_t>(&bytes, 7, is_big_endian);
  put<std::int32_t>(&bytes, 8, is_big_endian);
  put<float>(&bytes, 525, is_big_endian);
  for (const Eigen::Vector3d& p : kPoints) {
    put<std::uint8_t>(&bytes, 200);
    put<double>(&bytes, p.x(), is_big_endian);
    put<float>(&bytes, static_cast<float>(p.y()), is_big_endian);
    put<float>(&bytes, static_cast<float>(p.z()), is_big_endian);
  }
  put<std::uint8_t>(&bytes, 3);
  for (const int i : {0, 1, 2}) put<std::int32_t>(&bytes, i, is_big_endian);
  return bytes;
}

const char* const kAsciiPly =
    "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float z\r\nproperty list uchar int tags\r\nproperty float "
    "x\r\nproperty float y\r\n"
    "end_header\r\n0.5 2 7 8 1.5 -2.25\r\n8 0 2 4\r\n1 1 9 -3.125 0\r\n";

TEST(CloudFile, ReadsPly) {
  expect_points(read(binary_ply(false), "a.ply"), kPoints);
  expect_points(read(binary_ply(true), "a.ply"), kPoints);
  expect_points(read(kAsciiPly, "a.ply"), kPoints);
}

TEST(CloudFile, ReadsPlyWithListsInItsVertices) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty list uchar short tags\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    put<std::uint8_t>(&bytes, static_cast<std::uint8_t>(3 * i));
    for (int k = 0; k < 3 * i; ++k) put<std::int16_t>(&bytes, 5);
    for (int axis = 0; axis < 3; ++axis) put<float>(&bytes, static_cast<float>(kPoints[static_cast<std::size_t>(i)][axis]));
  }
  expect_points(read(bytes, "a.ply"), {kPoints[0], kPoints[1]});
}

TEST(CloudFile, RefusesBadPly) {
  const std::string good = binary_ply(false);
  expect_error(read(good.substr(0, good.size() - 20), "a.ply"), ErrorCode::kCorrupt, "truncated");
  expect_error(read(binary_ply(false, 1000000), "a.ply"), ErrorCode::kCorrupt, "promises 1000000");
  expect_error(read(binary_ply(false, std::uint64_t{1} << 62), "a.ply"), ErrorCode::kCorrupt, "do not fit");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n", "a.ply"),
               ErrorCode::kCorrupt, "x, y and z");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex -4\nend_header\n", "a.ply"), ErrorCode::kInvalid, "a.ply:3");
  expect_error(read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x", "a.ply"), ErrorCode::kCorrupt, "no end");
  std::string ascii = kAsciiPly;
  ascii.replace(ascii.find("8 0 2 4"), 7, "8 0 2 q");
  expect_error(read(ascii, "a.ply"), ErrorCode::kCorrupt, "vertex 1");
}

std::string pcd(const std::string& data, const std::string& payload, int points = 3) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 1 4 8 4\nTYPE U F F F\nCOUNT 3 1 1 "
         "1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n" +
         payload;
}

std::string pcd_records() {
  std::string bytes;
  for (const Eigen::Vector3d& p : kPoints) {
    bytes += "rgb";
    put<float>(&bytes, static_cast<float>(p.x()));
    put<double>(&bytes, p.y());
    put<float>(&bytes, static_cast<float>(p.z()));
  }
  return bytes;
}

/// Field by field; the colours as a back reference to themselves, the rest as literal runs.
std::string pcd_compressed() {
  std::string columns = "abcabcabc", packed = {2, 'a', 'b', 'c', static_cast<char>((4 << 5) | 0), 2};  // 6 bytes from 3 back
  std::string rest;
  for (const Eigen::Vector3d& p : kPoints) put<float>(&rest, static_cast<float>(p.x()));
  for (const Eigen::Vector3d& p : kPoints) put<double>(&rest, p.y());
  for (const Eigen::Vector3d& p : kPoints) put<float>(&rest, static_cast<float>(p.z()));
  for (std::size_t i = 0; i < rest.size(); i += 32) {
    const std::string run = rest.substr(i, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  std::string bytes;
  put<std::uint32_t>(&bytes, static_cast<std::uint32_t>(packed.size()));
  put<std::uint32_t>(&bytes, static_cast<std::uint32_t>(columns.size() + rest.size()));
  return bytes + packed;
}

TEST(CloudFile, ReadsPcd) {
  expect_points(read(pcd("ascii", "1 2 3 1.5 -2.25 0.5\n1 2 3 2 4 8\n1 2 3 -3.125 0 1\n"), "a.pcd"), kPoints);
  expect_points(read(pcd("binary", pcd_records()), "a.pcd"), kPoints);
  expect_points(read(pcd("binary_compressed", pcd_compressed()), "a.pcd"), kPoints);
}

TEST(CloudFile, RefusesBadPcd) {
  expect_error(read(pcd("binary", pcd_records(), 400), "a.pcd"), ErrorCode::kCorrupt, "promises 400");
  expect_error(read(pcd("ascii", "1 2 3 4 5 6\n"), "a.pcd"), ErrorCode::kCorrupt, "the file has 1");
  expect_error(read(pcd("ascii", "1 2 3 4\n"), "a.pcd"), ErrorCode::kCorrupt, "point 0");
  const std::string packed = pcd_compressed();
  expect_error(read(pcd("binary_compressed", packed.substr(0, 30)), "a.pcd"), ErrorCode::kCorrupt, "shorter");
  expect_error(read(pcd("binary_compressed", packed, 4), "a.pcd"), ErrorCode::kCorrupt, "not 4 points");
  std::string far_back = packed;
  far_back[13] = 120;  // refers to before the beginning
  expect_error(read(pcd("binary_compressed", far_back), "a.pcd"), ErrorCode::kCorrupt, "damaged");
  expect_error(read("VERSION 0.7\nFIELDS x y z\nSIZE 4 4\n", "a.pcd"), ErrorCode::kInvalid, "a.pcd:3");
  expect_error(read("VERSION 0.7\nFIELDS a b c\nDATA ascii\n", "a.pcd"), ErrorCode::kCorrupt, "x, y and z");
}

std::string las(int minor, int format, std::uint16_t record_bytes, std::uint64_t count) {
  std::string bytes(minor == 4 ? 375 : 227, '\0');
  std::copy_n("LASF", 4, bytes.data());
  bytes[24] = 1;
  bytes[25] = static_cast<char>(minor);
  bytes[104] = static_cast<char>(format);
  put_at(&bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  put_at(&bytes, 105, record_bytes);
  put_at(&bytes, 107, static_cast<std::uint32_t>(minor == 4 ? 0 : count));
  if (minor == 4) put_at(&bytes, 247, count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put_at(&bytes, 131 + 8 * axis, 0.001);
    put_at(&bytes, 155 + 8 * axis, axis == 0 ? 500000.0 : axis == 1 ? 5400000.0 : 100.0);
  }
  for (const Eigen::Vector3d& p : kPoints) {
    std::string record(record_bytes, '\0');
    for (int axis = 0; axis < 3; ++axis)
      put_at(&record, static_cast<std::size_t>(4 * axis), static_cast<std::int32_t>(std::lround(1000 * p[axis])));
    bytes += record;
  }
  return bytes;
}

TEST(CloudFile, ReadsLasWithSurveyCoordinates) {
  std::vector<Eigen::Vector3d> expected;
  for (const Eigen::Vector3d& p : kPoints) expected.push_back(p + Eigen::Vector3d(500000, 5400000, 100));
  expect_points(read(las(2, 0, 20, 3), "a.las"), expected, 1e-5);
  expect_points(read(las(2, 3, 40, 3), "a.las"), expected, 1e-5);
  expect_points(read(las(4, 10, 67, 3), "a.las"), expected, 1e-5);
  std::string withheld = las(4, 6, 30, 3);
  withheld[375 + 30 + 15] = 4;
  const auto cloud = read(withheld, "a.las");
  expect_points(cloud, {expected[0], expected[2]}, 1e-5);
  EXPECT_EQ(cloud.value().num_invalid, 1U);
}

TEST(CloudFile, RefusesBadLas) {
  expect_error(read(las(2, 0, 20, 4), "a.las"), ErrorCode::kCorrupt, "promises 4");
  expect_error(read(las(2, 3, 20, 3), "a.las"), ErrorCode::kCorrupt, "too short");
  expect_error(read(las(2, 0x83, 34, 3), "a.las"), ErrorCode::kUnsupported, "pdal");
  expect_error(read(las(2, 11, 80, 3), "a.las"), ErrorCode::kUnsupported, "point format 11");
  expect_error(read(las(5, 0, 20, 3), "a.las"), ErrorCode::kUnsupported, "LAS 1.5");
  expect_error(read(las(2, 0, 20, 3).substr(0, 200), "a.las"), ErrorCode::kCorrupt, "227");
  std::string no_scale = las(2, 0, 20, 3);
  put_at(&no_scale, 139, std::numeric_limits<double>::quiet_NaN());
  expect_error(read(no_scale, "a.las"), ErrorCode::kCorrupt, "scale");
}

TEST(CloudFile, ReadsTextTables) {
  const char* const tables[] = {
      "1.5 -2.25 0.5\n2 4 8\n-3.125 0 1\n",
      "# exported\n// by hand\n% twice\n\n1.5\t-2.25\t0.5\t255\t0\t0\r\n2 4 8 1 2 3\r\n# between\r\n-3.125 0 1 0 0 0\r\n",
      "X,Y,Z,Red\n1.5,-2.25,0.5,9\n2,4,8,9\n-3.125,0,1,9",
      "//X,Y,Z\n1.5,-2.25,0.5\n2,4,8\n-3.125,0,1\n",
      "\"intensity\";\"Z\";\"X\";\"Y\"\n7;0,5;1,5;-2,25\n7;8;2;4\n7;1;-3,125;0\n",
      "3\n1.5 -2.25 0.5 -1200 10 20 30\n2 4 8 0 0 0 0\n-3.125 0 1 0 0 0 0\n",
  };
  for (const char* table : tables) {
    SCOPED_TRACE(table);
    expect_points(read(table, "a.txt"), kPoints);
  }
}

TEST(CloudFile, RefusesBadText) {
  expect_error(read("1 2 3\n4 5\n", "a.xyz"), ErrorCode::kInvalid, "a.xyz:2");
  expect_error(read("1 2 3\nhello you there\n", "a.xyz"), ErrorCode::kInvalid, "a.xyz:2");
  expect_error(read("5\n1 2 3\n4 5 6\n", "a.pts"), ErrorCode::kCorrupt, "promises 5");
  expect_error(read("99999999999\n1 2 3\n", "a.pts"), ErrorCode::kCorrupt, "promises 99999999999");
  expect_error(read("x,y,z\n", "a.csv"), ErrorCode::kInvalid, "no points");
  expect_error(read("Dear reader, this is a letter.\nYours", "a.txt"), ErrorCode::kInvalid, "a.txt:2");
}

TEST(CloudFile, CountsWhatIsNotFinite) {
  const auto cloud = read("1 2 3\nnan nan nan\n4 inf 6\n7 8 9\n", "a.xyz");
  expect_points(cloud, {{1, 2, 3}, {7, 8, 9}});
  EXPECT_EQ(cloud.value().num_read, 4U);
  EXPECT_EQ(cloud.value().num_invalid, 2U);
  expect_error(read("nan nan nan\nnan nan nan\n", "a.xyz"), ErrorCode::kInvalid, "none of its 2 points");
}

TEST(CloudFile, SaysHowToConvertWhatItDoesNotRead) {
  expect_error(read("ASTM-E57 and so on", "a.e57"), ErrorCode::kUnsupported, "CloudCompare");
  expect_error(read("LASF and so on", "a.laz"), ErrorCode::kUnsupported, "pdal");
  expect_error(read(std::string("\x89PNG\0\1\2", 7), "a.png"), ErrorCode::kUnsupported, "PLY, PCD, LAS");
  expect_error(read("", "a.ply"), ErrorCode::kInvalid, "empty");
  expect_error(read_cloud("/no/such/file.ply", {}), ErrorCode::kNotFound, "no such file");
  expect_error(read_cloud("/", {}), ErrorCode::kInvalid, "folder");
}

TEST(CloudFile, StopsWhenAskedTo) {
  std::string text;
  for (int i = 0; i < 200000; ++i) text += "1.25 2.25 3.25\n";
  std::istringstream stream(text);
  testing::RecordingObserver observer(2);
  const auto cloud = read_cloud(stream, "a.xyz", {}, observer);
  ASSERT_EQ(observer.steps.size(), 2U);
  EXPECT_EQ(observer.steps[0].what, "reading the cloud: 0 of 3 MB");
  EXPECT_EQ(observer.steps[1].what, "reading the cloud: 1 of 3 MB");
  expect_error(cloud, ErrorCode::kIo, "interrupted");
}

TEST(CloudFile, TakesUnits) {
  CloudOptions options;
  options.unit_m = 0.001;
  const auto cloud = read("1500 -2250 500\n2000 4000 8000\n", "a.xyz", options);
  expect_points(cloud, {{1.5, -2.25, 0.5}, {2, 4, 8}});
}

TEST(CloudAccumulator, KeepsTheMeanOfAVoxel) {
  CloudAccumulator accumulator({0.1, 1, 2});
  for (const double x : {0.01, 0.03, 0.05, 7.5}) accumulator.add({1000000 + x, 0.05, 0.05});  // the last is alone
  const PointCloud cloud = accumulator.finish();
  ASSERT_EQ(cloud.points_m.size(), 1U);
  EXPECT_NEAR(cloud.origin_m.x() + static_cast<double>(cloud.points_m[0].x()), 1000000.03, 1e-5);
}

TEST(CloudAccumulator, IsTheSameThroughManyCompactions) {
  // More points than fit between two compactions, in another order than their voxels.
  CloudAccumulator accumulator({1.0, 1, 1});
  std::uint64_t state = 1;
  for (int i = 0; i < 3000000; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    accumulator.add({static_cast<double>((state >> 33) % 100) + 0.5, static_cast<double>((state >> 43) % 100) + 0.5, 0.5});
  }
  const PointCloud cloud = accumulator.finish();
  EXPECT_EQ(cloud.points_m.size(), 10000U);
  EXPECT_EQ(cloud.num_read, 3000000U);
  for (const Eigen::Vector3f& p : cloud.points_m) EXPECT_NEAR(p.x() - std::floor(p.x()), 0.5F, 1e-3F);
}

TEST(CloudAccumulator, IsNotMisledByAStrayFirstPoint) {
  CloudAccumulator accumulator({0.01, 1, 1});
  accumulator.add({0, 0, 0});
  for (int i = 0; i < 10000; ++i) accumulator.add({500000 + 0.02 * i, 5400000.123, 100});
  const PointCloud cloud = accumulator.finish();
  EXPECT_GT(cloud.origin_m.x(), 499000);
  const auto bounds = cloud.bounds_m();
  EXPECT_LT((bounds[1] - bounds[0]).norm(), 210);
  double worst = 0;
  for (const Eigen::Vector3f& p : cloud.points_m) {
    if (cloud.origin_m.x() + static_cast<double>(p.x()) > 1000)
      worst = std::max(worst, std::abs(cloud.origin_m.y() + static_cast<double>(p.y()) - 5400000.123));
  }
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace camloc::mapping
