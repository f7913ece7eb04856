// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What goes into a map comes out again, up to the quantization; contradictory data are refused. How the file
// is replaced is tested in replace_file_test.cc.
#include "core/map/map_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "core/map/map_view.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using testing::make_synthetic_map;
using testing::read_bytes;
using testing::TemporaryFolder;

MapView open_written(const MapData& map, const TemporaryFolder& folder, const MapWriteOptions& options = {}) {
  const std::string path = folder.file("map.cmap");
  const Status written = write_map(map, path, options);
  EXPECT_TRUE(written.is_ok()) << written.message();
  Result<MapView> view = MapView::open(path);
  EXPECT_TRUE(view.is_ok()) << view.status().message();
  return std::move(view).value();
}

/// Landmarks of synthetic maps are told apart by their first descriptor.
std::map<std::array<std::uint64_t, 4>, std::uint32_t> index_by_descriptor(const MapView& view) {
  std::map<std::array<std::uint64_t, 4>, std::uint32_t> index;
  for (std::uint32_t i = 0; i < view.info().num_landmarks; ++i) index[view.landmark_descriptors(i)[0].bits] = i;
  return index;
}

void expect_same_landmark(const MapLandmark& expected, const MapView& view, std::uint32_t index, float position_step_m) {
  const auto& record = view.landmarks()[index];
  EXPECT_LE((view.position_m(index) - expected.position_m).cwiseAbs().maxCoeff(), 0.51F * position_step_m + 1e-6F);
  EXPECT_GT(MapView::direction(record).dot(expected.direction), 0.9998F);
  EXPECT_LE(MapView::view_cosine(record), expected.view_cosine + 1e-6F);
  EXPECT_NEAR(MapView::view_cosine(record), expected.view_cosine, 0.008F);
  EXPECT_LE(MapView::reference_m(record.min_reference), expected.min_reference_m);
  EXPECT_GE(MapView::reference_m(record.max_reference), expected.max_reference_m);
  EXPECT_LT(MapView::reference_m(record.max_reference) / expected.max_reference_m, 1.03F);
  EXPECT_NEAR(std::remainder(MapView::angle_rad(record) - expected.angle_rad, 6.2831853F), 0, 0.0124F);
  EXPECT_NEAR(record.position_sigma_mm, expected.position_sigma_m * 1000, 0.51);
  EXPECT_EQ(record.num_observations, std::min<std::uint32_t>(expected.num_observations, 255));
  ASSERT_EQ(view.num_descriptors(index), expected.descriptors.size());
  const auto descriptors = view.landmark_descriptors(index);
  EXPECT_TRUE(std::equal(descriptors.begin(), descriptors.end(), expected.descriptors.begin()));
  EXPECT_EQ(&view.descriptors()[view.first_descriptor(index)], descriptors.data());
}

TEST(MapWriter, LandmarksRoundTrip) {
  const TemporaryFolder folder;
  const MapData map = make_synthetic_map({.num_landmarks = 500, .landmarks_per_keyframe = 100});
  const MapView view = open_written(map, folder);
  ASSERT_EQ(view.info().num_landmarks, 500U);
  const auto index = index_by_descriptor(view);
  ASSERT_EQ(index.size(), 500U);
  for (const auto& landmark : map.landmarks) { expect_same_landmark(landmark, view, index.at(landmark.descriptors[0].bits), 4.0F / 65535); }
}

TEST(MapWriter, KeyframesFollowTheReorderedLandmarks) {
  const TemporaryFolder folder;
  const MapData map = make_synthetic_map({.num_landmarks = 3000, .num_keyframes = 7, .landmarks_per_keyframe = 90});
  const MapView view = open_written(map, folder);
  const auto index = index_by_descriptor(view);
  ASSERT_EQ(view.info().num_keyframes, 7U);
  EXPECT_EQ(view.info().max_keyframe_landmarks, 90U);
  for (std::uint32_t k = 0; k < 7; ++k) {
    EXPECT_LT((view.keyframe_pose(k).translation - map.keyframes[k].T_map_camera.translation).norm(), 1e-5);
    EXPECT_LT(rotation_distance_rad(view.keyframe_pose(k).rotation, map.keyframes[k].T_map_camera.rotation), 1e-5);
    std::vector<std::uint32_t> expected;
    for (const auto landmark : map.keyframes[k].landmarks) { expected.push_back(index.at(map.landmarks[landmark].descriptors[0].bits)); }
    std::sort(expected.begin(), expected.end());
    std::vector<std::uint32_t> stored(90);
    ASSERT_EQ(view.keyframe_landmarks(k, stored), 90U);
    EXPECT_EQ(stored, expected);
  }
}

TEST(MapWriter, CubesPartitionTheLandmarks) {
  const TemporaryFolder folder;
  const MapData map = make_synthetic_map({.num_landmarks = 800, .side_m = 15});
  const MapView view = open_written(map, folder, {.cube_m = 2.5});
  std::set<std::array<float, 3>> origins;
  std::uint32_t next = 0;
  for (std::uint32_t s = 0; s < view.cubes().size(); ++s) {
    const auto& cube = view.cubes()[s];
    EXPECT_TRUE(origins.insert(cube.origin_m).second);
    EXPECT_EQ(cube.extent_m, 2.5F);
    EXPECT_EQ(cube.first_landmark, next);
    next += cube.num_landmarks;
    for (std::uint32_t i = cube.first_landmark; i < next; ++i) {
      EXPECT_EQ(view.cube_of(i), s);
      EXPECT_EQ(view.position_m(i), MapView::position_m(cube, view.landmarks()[i]));
    }
  }
  EXPECT_EQ(next, 800U);
  EXPECT_EQ(view.cubes().size(), view.info().num_cubes);
}

TEST(MapWriter, WordsAndGlobalsRoundTrip) {
  const TemporaryFolder folder;
  const MapData map = make_synthetic_map();
  const MapView view = open_written(map, folder);
  ASSERT_EQ(view.info().num_words, map.words.size());
  for (std::uint32_t w = 0; w < map.words.size(); ++w) {
    EXPECT_EQ(view.words()[w], map.words[w]);
    ASSERT_EQ(view.word_keyframes(w).size(), map.inverted_file[w].size());
    for (std::size_t i = 0; i < map.inverted_file[w].size(); ++i) {
      EXPECT_EQ(view.word_keyframes(w)[i], map.inverted_file[w][i].keyframe);
      EXPECT_EQ(view.word_weights(w)[i], map.inverted_file[w][i].weight);
    }
  }
  const MapInfo& info = view.info();
  EXPECT_EQ(info.name, map.name);
  EXPECT_EQ(info.version, map_format::kVersion);
  EXPECT_EQ(info.pose_sigma_m, map.pose_sigma_m);
  EXPECT_EQ(info.pose_sigma_rad, map.pose_sigma_rad);
  EXPECT_EQ(info.orb_scale_factor, map.orb_scale_factor);
  EXPECT_EQ(info.orb_num_levels, map.orb_num_levels);
  EXPECT_EQ(info.camera.name, map.camera.name);
  EXPECT_EQ(info.camera.color.fx, map.camera.color.fx);
  EXPECT_EQ(info.camera.color.cy, map.camera.color.cy);
  EXPECT_EQ(info.camera.color.lens, map.camera.color.lens);
  EXPECT_EQ(info.camera.color.distortion, map.camera.color.distortion);
  EXPECT_EQ(info.camera.depth.fy, map.camera.depth.fy);
  EXPECT_EQ(info.camera.depth_noise.constant_m, map.camera.depth_noise.constant_m);
  EXPECT_EQ(info.camera.is_depth_registered, false);
  EXPECT_EQ(info.camera.poses_are_of_depth_camera, true);
  EXPECT_EQ(info.camera.T_color_depth.translation, map.camera.T_color_depth.translation);
  ASSERT_TRUE(info.wcs.has_value());
  EXPECT_EQ(info.wcs->T_wcs_map.translation, map.wcs->T_wcs_map.translation);
  EXPECT_EQ(info.wcs->covariance, map.wcs->covariance);
}

TEST(MapWriter, MapsWithoutWordsKeyframesOrDatumAreMaps) {
  const TemporaryFolder folder;
  const MapData map = make_synthetic_map({.num_landmarks = 1, .num_keyframes = 0, .num_words = 0, .has_wcs = false});
  const MapView view = open_written(map, folder);
  EXPECT_EQ(view.info().num_keyframes, 0U);
  EXPECT_EQ(view.info().num_words, 0U);
  EXPECT_EQ(view.info().max_keyframe_landmarks, 0U);
  EXPECT_FALSE(view.info().wcs.has_value());
}

TEST(MapWriter, SameMapGivesSameBytesAndId) {
  const auto first = serialize_map(make_synthetic_map({.seed = 5}));
  const auto second = serialize_map(make_synthetic_map({.seed = 5}));
  ASSERT_TRUE(first.is_ok() && second.is_ok());
  EXPECT_EQ(*first, *second);

  const TemporaryFolder folder;
  const std::uint64_t id = open_written(make_synthetic_map({.seed = 5}), folder).info().map_id;
  EXPECT_EQ(open_written(make_synthetic_map({.seed = 5}), folder).info().map_id, id);
  MapData changed = make_synthetic_map({.seed = 5});
  changed.landmarks[7].descriptors[0].bits[2] ^= 1;
  EXPECT_NE(open_written(changed, folder).info().map_id, id);
}

TEST(MapWriter, RefusesContradictoryData) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    const char* what;
    std::function<void(MapData*)> spoil;
  };
  const Case cases[] = {
      {"no landmark", [](MapData* m) { m->landmarks.clear(); }},
      {"nan position", [](MapData* m) { m->landmarks[3].position_m.y() = kNan; }},
      {"far position", [](MapData* m) { m->landmarks[3].position_m.y() = 1e7F; }},
      {"zero direction", [](MapData* m) { m->landmarks[3].direction.setZero(); }},
      {"nan cosine", [](MapData* m) { m->landmarks[3].view_cosine = kNan; }},
      {"references swapped", [](MapData* m) { m->landmarks[3].max_reference_m = 0.01F; }},
      {"nan angle", [](MapData* m) { m->landmarks[3].angle_rad = kNan; }},
      {"negative sigma", [](MapData* m) { m->landmarks[3].position_sigma_m = -1; }},
      {"no descriptor", [](MapData* m) { m->landmarks[3].descriptors.clear(); }},
      {"256 descriptors", [](MapData* m) { m->landmarks[3].descriptors.resize(256); }},
      {"list beyond the landmarks", [](MapData* m) { m->keyframes[1].landmarks.back() = 40; }},
      {"list not ascending", [](MapData* m) { m->keyframes[1].landmarks[1] = m->keyframes[1].landmarks[0]; }},
      {"pose not a rotation", [](MapData* m) { m->keyframes[1].T_map_camera.rotation.coeffs() *= 1.1; }},
      {"pose not finite", [](MapData* m) { m->keyframes[1].T_map_camera.translation.x() = kNan; }},
      {"inverted file too short", [](MapData* m) { m->inverted_file.pop_back(); }},
      {"inverted keyframe beyond",
       [](MapData* m) {
         m->inverted_file[0] = {{3, 1}};
       }},
      {"inverted not ascending",
       [](MapData* m) {
         m->inverted_file[0] = {{1, 1}, {1, 1}};
       }},
      {"zero weight",
       [](MapData* m) {
         m->inverted_file[0] = {{1, 0}};
       }},
      {"long name", [](MapData* m) { m->name.assign(64, 'x'); }},
      {"bad camera", [](MapData* m) { m->camera.color.fx = -1; }},
      {"negative pose sigma", [](MapData* m) { m->pose_sigma_m = -0.1; }},
      {"no pyramid", [](MapData* m) { m->orb_num_levels = 0; }},
      {"an extra section with the id of a core one", [](MapData* m) { m->extra_sections[map_format::SectionId::kWcs] = {}; }},
      {"an extra section of broken elements",
       [](MapData* m) {
         m->extra_sections[map_format::section_id("TEST")] = {true, 4, std::vector<std::byte>(6)};
       }},
      {"an extra section of elements of no size",
       [](MapData* m) {
         m->extra_sections[map_format::section_id("TEST")] = {true, 0, {}};
       }},
      {"too many extra sections",
       [](MapData* m) {
         for (std::uint32_t i = 0; i < 54; ++i) m->extra_sections[map_format::SectionId{1000 + i}] = {};
       }},
      {"nan wcs", [](MapData* m) { m->wcs->covariance(2, 3) = kNan; }},
  };
  for (const Case& c : cases) {
    MapData map = make_synthetic_map();
    c.spoil(&map);
    const auto bytes = serialize_map(map);
    ASSERT_FALSE(bytes.is_ok()) << c.what;
    EXPECT_EQ(bytes.status().code(), ErrorCode::kInvalid) << c.what;
    EXPECT_FALSE(bytes.status().message().empty());
  }
  EXPECT_FALSE(serialize_map(make_synthetic_map(), {.cube_m = 0}).is_ok());
}

std::size_t num_files(const TemporaryFolder& folder) {
  const auto files = std::filesystem::directory_iterator(folder.path());
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(MapWriter, ReplacesTheFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  ASSERT_TRUE(write_map(make_synthetic_map({.seed = 1}), path).is_ok());
  ASSERT_TRUE(write_map(make_synthetic_map({.seed = 2}), path).is_ok());
  EXPECT_EQ(read_bytes(path), *serialize_map(make_synthetic_map({.seed = 2})));
  EXPECT_EQ(num_files(folder), 1U);
}

TEST(MapWriter, RefusesAFolderAndAMissingFolder) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_map(make_synthetic_map(), folder.path().string()).code(), ErrorCode::kIo);
  EXPECT_EQ(write_map(make_synthetic_map(), folder.file("missing/map.cmap")).code(), ErrorCode::kIo);
  EXPECT_EQ(num_files(folder), 0U);
}

}  // namespace
}  // namespace camloc
