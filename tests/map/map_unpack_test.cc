// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Pack, open, unpack, pack: the same bytes, also where a code could be read in two ways.
#include "core/map/map_unpack.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/map/landmark_codes.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using testing::make_synthetic_map;
using testing::Random;
using testing::TemporaryFolder;

std::vector<std::byte> packed(const MapData& map, const MapWriteOptions& options = {}) {
  const Result<std::vector<std::byte>> bytes = serialize_map(map, options);
  EXPECT_TRUE(bytes.is_ok()) << bytes.status().message();
  return bytes.is_ok() ? *bytes : std::vector<std::byte>{};
}

struct Unpacked {
  MapData map;
  MapWriteOptions options;
};

Unpacked unpacked(const std::vector<std::byte>& bytes) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("map.cmap"), bytes);
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  EXPECT_TRUE(view.is_ok()) << view.status().message();
  if (!view.is_ok()) return {};
  return {unpack_map(*view), write_options_of(*view)};
}

void expect_same_bytes(const MapData& map, const MapWriteOptions& options = {}) {
  const std::vector<std::byte> bytes = packed(map, options);
  const Unpacked again = unpacked(bytes);
  EXPECT_EQ(again.options.cube_m, options.cube_m);
  EXPECT_EQ(again.map.landmarks.size(), map.landmarks.size());
  EXPECT_TRUE(packed(again.map, again.options) == bytes);
}

TEST(MapUnpack, SameBytes) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    expect_same_bytes(make_synthetic_map({.num_landmarks = 400,
                                          .num_keyframes = 30,
                                          .landmarks_per_keyframe = 60,
                                          .side_m = seed * 2.0,
                                          .has_wcs = seed % 2 == 0,
                                          .seed = seed}));
  }
}

TEST(MapUnpack, SameBytesWithoutWordsKeyframesAndDatum) {
  expect_same_bytes(make_synthetic_map({.num_keyframes = 0, .num_words = 0, .has_wcs = false}));
}

TEST(MapUnpack, SameBytesWithOtherCubes) {
  const MapData map = make_synthetic_map({.num_landmarks = 300, .side_m = 30});
  for (const double cube_m : {0.1, 0.3, 1.7, 4.0, 12.5, 1000.0}) expect_same_bytes(map, {.cube_m = cube_m});
}

// On the faces of the cubes, a bit beside them, and so far out that floats are coarser than the codes.
TEST(MapUnpack, SameBytesOnFacesOfCubesAndFarOut) {
  MapData map = make_synthetic_map({.num_landmarks = 1});
  const MapLandmark pattern = map.landmarks[0];
  map.landmarks.clear();
  map.keyframes.clear();
  map.words.clear();
  map.inverted_file.clear();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float face : {0.0F, 4.0F, -4.0F, 8.0F, 400.0F, -1024.0F, 5000.0F, -99996.0F, 999996.0F}) {
    for (const float x :
         {face, std::nextafter(face, kInfinity), std::nextafter(face, -kInfinity), face + 2e-5F, face - 2e-5F, face + 1.2345F}) {
      map.landmarks.push_back(pattern);
      map.landmarks.back().position_m = {x, -x, 0.5F * x};
    }
  }
  expect_same_bytes(map);
}

// Each code a direction, a cosine, an angle and a reference distance can have.
TEST(MapUnpack, SameBytesForEveryCode) {
  MapData map = make_synthetic_map({.num_landmarks = 1, .num_keyframes = 0, .num_words = 0});
  const MapLandmark pattern = map.landmarks[0];
  map.landmarks.clear();
  Random random(5);
  for (int i = 0; i < 60000; ++i) {
    MapLandmark& landmark = map.landmarks.emplace_back(pattern);
    landmark.position_m.x() = static_cast<float>(random.uniform(-9, 9));
    Eigen::Vector3d direction = random.direction();
    // A third of them close to where the octahedron was cut open.
    if (i % 3 == 0) direction[i / 3 % 3] = random.uniform(-0.004, 0.004);
    if (i % 9 == 0) direction.z() = -std::abs(direction.z());
    landmark.direction = direction.normalized().cast<float>();
    landmark.view_cosine = std::min(1.0F, static_cast<float>(i % 1024) / 510.0F - 1.0F);
    landmark.angle_rad = static_cast<float>(2 * std::numbers::pi * (i % 512) / 512.0);
    landmark.min_reference_m = 0.05F * std::pow(1.0281F, static_cast<float>(i % 300) - 10);
    landmark.max_reference_m = landmark.min_reference_m * 1.3F;
    landmark.position_sigma_m = static_cast<float>(i % 70000) * 0.001F;
  }
  for (const auto& axis : {Eigen::Vector3f(0, 0, -1), Eigen::Vector3f(-1, 0, 0), Eigen::Vector3f(0, -1, 0), Eigen::Vector3f(0, 0, 1)}) {
    map.landmarks.emplace_back(pattern).direction = axis;
    map.landmarks.emplace_back(pattern).direction = (axis + Eigen::Vector3f(-1e-5F, 2e-5F, -1e-5F)).normalized();
  }
  expect_same_bytes(map);
}

// A quaternion that is a unit only to a few bits, as a chain of products leaves it.
TEST(MapUnpack, SameBytesForSloppyQuaternions) {
  MapData map = make_synthetic_map({.num_keyframes = 200});
  Random random(3);
  for (MapKeyframe& keyframe : map.keyframes) keyframe.T_map_camera.rotation.coeffs() *= 1 + random.uniform(-4e-7, 4e-7);
  map.camera.T_color_depth.rotation.coeffs() *= 1 + 3e-7;
  map.wcs->T_wcs_map.rotation.coeffs() *= 1 - 5e-7;
  expect_same_bytes(map);
}

TEST(MapUnpack, ValuesAreThoseOfTheFile) {
  const MapData map = make_synthetic_map({.num_landmarks = 50});
  const Unpacked again = unpacked(packed(map));
  EXPECT_EQ(again.map.name, map.name);
  EXPECT_EQ(again.map.camera.name, map.camera.name);
  EXPECT_EQ(again.map.words, map.words);
  ASSERT_TRUE(again.map.wcs.has_value());
  EXPECT_EQ(again.map.wcs->T_wcs_map.translation, map.wcs->T_wcs_map.translation);
  EXPECT_EQ(again.map.wcs->covariance, map.wcs->covariance);
  for (const MapLandmark& landmark : again.map.landmarks) {
    const auto same = std::find_if(map.landmarks.begin(), map.landmarks.end(),
                                   [&](const MapLandmark& other) { return other.descriptors == landmark.descriptors; });
    ASSERT_NE(same, map.landmarks.end());
    EXPECT_LT((same->position_m - landmark.position_m).norm(), 1e-4F);
    EXPECT_GT(same->direction.dot(landmark.direction), 0.9998F);
    EXPECT_NEAR(same->view_cosine, landmark.view_cosine, 0.008F);
  }
}

// The point of it: change one thing and write it back.
TEST(MapUnpack, ANewDatumChangesNothingElse) {
  const std::vector<std::byte> bytes = packed(make_synthetic_map({.has_wcs = false}));
  Unpacked again = unpacked(bytes);
  again.map.wcs = WcsDatum{{Eigen::Quaterniond(0.6, 0, 0, 0.8), {456789.123456, 5432109.87654, 123.456}}, Matrix6d::Identity()};
  const Unpacked with_datum = unpacked(packed(again.map));
  ASSERT_TRUE(with_datum.map.wcs.has_value());
  EXPECT_EQ(with_datum.map.wcs->T_wcs_map.translation, again.map.wcs->T_wcs_map.translation);
  again.map.wcs.reset();
  EXPECT_TRUE(packed(again.map) == bytes);
}

}  // namespace
}  // namespace camloc
