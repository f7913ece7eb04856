// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Survey scans in LAS.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/mapping/cloud_bytes.h"

namespace camloc::mapping {
namespace {

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

TEST(CloudLas, ReadsLasWithSurveyCoordinates) {
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

/// With variable length records after the header, of user LASF_Projection.
std::string las_with_records(const std::vector<std::pair<std::uint16_t, std::string>>& records) {
  std::string bytes = las(2, 0, 20, 3), packed;
  for (const auto& [id, body] : records) {
    std::string head(54, '\0');
    std::copy_n("LASF_Projection", 15, head.data() + 2);
    put_at(&head, 18, id);
    put_at(&head, 20, static_cast<std::uint16_t>(body.size()));
    packed += head + body;
  }
  put_at(&bytes, 94, std::uint16_t{227});
  put_at(&bytes, 96, static_cast<std::uint32_t>(227 + packed.size()));
  put_at(&bytes, 100, static_cast<std::uint32_t>(records.size()));
  return bytes.insert(227, packed);
}

std::string geo_keys(const std::vector<std::array<std::uint16_t, 4>>& keys) {
  std::string bytes;
  for (const int value : {1, 1, 0, static_cast<int>(keys.size())}) put(&bytes, static_cast<std::uint16_t>(value));
  for (const auto& key : keys) {
    for (const std::uint16_t value : key) put(&bytes, value);
  }
  return bytes;
}

std::vector<Eigen::Vector3d> scaled_survey(double plane, double height) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : kPoints) points.emplace_back(plane * (p.x() + 500000), plane * (p.y() + 5400000), height * (p.z() + 100));
  return points;
}

TEST(CloudLas, TakesTheUnitFromGeoKeys) {
  const double foot = 1200.0 / 3937.0;
  const auto cloud = read(las_with_records({{34735, geo_keys({{1024, 0, 1, 1}, {3076, 0, 1, 9003}, {4099, 0, 1, 9003}})}}), "a.las");
  expect_points(cloud, scaled_survey(foot, foot), 1e-4);
  EXPECT_NE(cloud->unit_from.find("US survey feet"), std::string::npos) << cloud->unit_from;
  expect_points(read(las_with_records({{34735, geo_keys({{3076, 0, 1, 9002}, {4099, 0, 1, 9001}})}}), "a.las"), scaled_survey(0.3048, 1),
                1e-4);
  std::string size;
  put(&size, 0.25);
  expect_points(read(las_with_records({{34736, size}, {34735, geo_keys({{3076, 0, 1, 32767}, {3077, 34736, 1, 0}})}}), "a.las"),
                scaled_survey(0.25, 0.25), 1e-4);
  EXPECT_NE(read(las(2, 0, 20, 3), "a.las")->unit_from.find("assumed"), std::string::npos);
}

TEST(CloudLas, TakesTheUnitFromWkt) {
  const std::string geographic = "GEOGCS[\"NAD83\",DATUM[\"x\",SPHEROID[\"GRS 1980\",6378137,298.2]],UNIT[\"degree\",0.0174532925199433]]";
  const std::string one =
      "COMPD_CS[\"a [b]\",PROJCS[\"NY\"," + geographic +
      ",PARAMETER[\"x\",1],UNIT[\"US survey foot\",0.304800609601219,AUTHORITY[\"EPSG\",\"9003\"]]],VERT_CS[\"v\",UNIT[\"metre\",1]]]";
  expect_points(read(las_with_records({{2112, one}}), "a.las"), scaled_survey(1200.0 / 3937.0, 1), 1e-4);
  const std::string two =
      "PROJCRS[\"NY\",BASEGEOGCRS[\"n\",DATUM[\"d\",ELLIPSOID[\"GRS\",6378137,298.2,LENGTHUNIT[\"metre\",1]]]],CS[Cartesian,2],"
      "AXIS[\"easting\",east,ORDER[1],LENGTHUNIT[\"foot\",0.3048]],AXIS[\"northing\",north,ORDER[2],LENGTHUNIT[\"foot\",0.3048]]]";
  expect_points(read(las_with_records({{2112, two}}), "a.las"), scaled_survey(0.3048, 0.3048), 1e-4);
  expect_error(read(las_with_records({{2112, geographic}}), "a.las"), ErrorCode::kInvalid, "degrees");
  expect_error(read(las_with_records({{34735, geo_keys({{1024, 0, 1, 2}})}}), "a.las"), ErrorCode::kInvalid, "degrees");
}

TEST(CloudLas, AnOptionGoesBeforeTheFileAndIsNotSilent) {
  const std::string feet = las_with_records({{34735, geo_keys({{3076, 0, 1, 9003}})}});
  CloudOptions options;
  options.unit_m = 1;
  const auto cloud = read(feet, "a.las", options);
  expect_points(cloud, scaled_survey(1, 1), 1e-4);
  ASSERT_EQ(cloud->warnings.size(), 1U);
  EXPECT_NE(cloud->warnings[0].find("US survey feet"), std::string::npos) << cloud->warnings[0];
  options.unit_m = 1200.0 / 3937.0;
  EXPECT_TRUE(read(feet, "a.las", options)->warnings.empty());
}

TEST(CloudLas, PassesOverDamagedRecords) {
  std::string bytes = las_with_records({{34735, geo_keys({{3076, 0, 1, 9003}})}});
  put_at(&bytes, 227 + 20, std::uint16_t{65535});
  expect_points(read(bytes, "a.las"), scaled_survey(1, 1), 1e-4);
  expect_points(read(las_with_records({{2112, "PROJCS[\"x"}, {34735, "abc"}}), "a.las"), scaled_survey(1, 1), 1e-4);
}

TEST(CloudLas, RefusesBadLas) {
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

}  // namespace
}  // namespace camloc::mapping
