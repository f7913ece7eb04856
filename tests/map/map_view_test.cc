// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is no map file is refused with a reason; a map that changes under an open view never leads a reader out of bounds.
// (What a good map holds is tested with the writer, what a damaged one in map_sections_test.cc and section_table_test.cc.)
#include "core/map/map_view.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/unique_fd.h"
#include "core/map/map_writer.h"
#include "core/map/retrieval.h"
#include "tests/map/damaged_map.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using testing::expect_refused;
using testing::make_synthetic_map;
using testing::open_status;
using testing::small_map;
using testing::TemporaryFolder;

TEST(MapViewOpen, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  expect_refused(folder.file("missing.cmap"), ErrorCode::kNotFound, "No such file");
  expect_refused(folder.path().string(), ErrorCode::kIo, "folder");
  testing::write_bytes(folder.file("empty.cmap"), {});
  expect_refused(folder.file("empty.cmap"), ErrorCode::kCorrupt, "empty");
  ASSERT_EQ(::mkfifo(folder.file("pipe.cmap").c_str(), 0600), 0);
  expect_refused(folder.file("pipe.cmap"), ErrorCode::kIo, "no regular file");
  const std::vector<std::byte> text(5000, std::byte{'x'});
  testing::write_bytes(folder.file("text.cmap"), text);
  expect_refused(folder.file("text.cmap"), ErrorCode::kCorrupt, "does not begin like a camloc map");
  expect_refused(folder.file("text.cmap/below"), ErrorCode::kNotFound, "Not a directory");
}

// In a child, because root may read anything and cannot come back from another user.
TEST(MapViewOpenDeathTest, RefusesAnUnreadableFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, small_map());
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0200), 0);
  EXPECT_EXIT(
      {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
        const Status status = open_status(path);
        ::_exit(status.code() == ErrorCode::kIo && status.message().find("ermission") != std::string::npos ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

/// Calls everything and touches every byte that a reader may touch.
std::uint64_t use_everything(const MapView& view) {
  const MapInfo& info = view.info();
  std::uint64_t sum = view.is_damaged() ? 1 : 0;
  for (const auto& d : view.descriptors()) sum += d.bits[0] ^ d.bits[3];
  for (std::uint32_t i = 0; i < info.num_landmarks; ++i) {
    const std::uint32_t cube = view.cube_of(i);
    EXPECT_LT(cube, info.num_cubes);
    EXPECT_LE(view.first_descriptor(i) + view.num_descriptors(i), info.num_descriptors);
    for (const auto& d : view.landmark_descriptors(i)) sum += d.bits[1];
    const auto& record = view.landmarks()[i];
    EXPECT_NEAR(MapView::direction(record).norm(), 1, 1e-4);
    EXPECT_GT(MapView::reference_m(record.min_reference) + MapView::angle_rad(record) + MapView::view_cosine(record), -1.0F);
    EXPECT_LE((view.position_m(i) - Eigen::Vector3f(view.cubes()[cube].origin_m.data())).maxCoeff(), 4.001F);
  }
  std::vector<std::uint32_t> list(info.max_keyframe_landmarks);
  for (std::uint32_t k = 0; k < info.num_keyframes; ++k) {
    EXPECT_TRUE(view.keyframe_pose(k).translation.allFinite());
    const std::size_t count = view.keyframe_landmarks(k, list);
    EXPECT_EQ(count, view.keyframes()[k].num_landmark_entries);
    for (std::size_t i = 0; i < count; ++i) EXPECT_LT(list[i], info.num_landmarks);
  }
  for (std::uint32_t w = 0; w < info.num_words; ++w) {
    EXPECT_EQ(view.word_keyframes(w).size(), view.word_weights(w).size());
    for (std::size_t i = 0; i < view.word_keyframes(w).size(); ++i) sum += view.word_keyframes(w)[i] + view.word_weights(w)[i];
    EXPECT_TRUE(std::isfinite(view.word_idf(w)));
  }
  Retriever retriever(view, 100);
  for (const auto& r : retriever.retrieve(view.words(), 10)) EXPECT_LT(r.keyframe, info.num_keyframes);
  return sum;
}

TEST(MapView, OverwrittenWhileMappedStaysInBounds) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, small_map({.num_landmarks = 300, .num_keyframes = 5, .landmarks_per_keyframe = 60}));
  const Result<MapView> view = MapView::open(path);
  ASSERT_TRUE(view.is_ok()) << view.status().message();
  const std::uint64_t before = use_everything(*view);
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  std::mt19937 random(9);
  for (const int fill : {-1, -1, -1, 0xFF, 0x00, 0x80}) {
    std::vector<std::uint8_t> noise(view->info().file_bytes);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(fill < 0 ? random() : static_cast<unsigned>(fill));
    ASSERT_EQ(::pwrite(fd.get(), noise.data(), noise.size(), 0), static_cast<ssize_t>(noise.size()));
    EXPECT_NE(use_everything(*view), before);  // the noise does show
  }
}

TEST(MapView, UnpacksNoMoreThanTheBufferHolds) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("map.cmap"), small_map());
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  ASSERT_TRUE(view.is_ok());
  std::vector<std::uint32_t> all(15), some(6, 77);
  ASSERT_EQ(view->keyframe_landmarks(1, all), 15U);
  ASSERT_EQ(view->keyframe_landmarks(1, std::span(some).first(5)), 5U);
  EXPECT_TRUE(std::equal(some.begin(), some.begin() + 5, all.begin()));
  EXPECT_EQ(some[5], 77U);
  EXPECT_EQ(view->keyframe_landmarks(1, {}), 0U);
}

TEST(MapView, LivesOnWhenItsFileIsReplaced) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  ASSERT_TRUE(write_map(make_synthetic_map(), path).is_ok());
  const MapView view = MapView::open(path).value();
  const std::uint64_t before = use_everything(view);
  ASSERT_TRUE(write_map(make_synthetic_map({.seed = 2}), path).is_ok());
  EXPECT_EQ(use_everything(view), before);
  std::filesystem::remove(path);
  EXPECT_EQ(use_everything(view), before);
}

TEST(MapView, WalksThroughAllPositionsInTheOrderOfTheFile) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("map.cmap"), small_map({.num_landmarks = 300, .side_m = 30}));
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  ASSERT_TRUE(view.is_ok());
  ASSERT_GT(view->cubes().size(), 10U);
  std::uint32_t next = 0;
  view->for_each_position([&](const map_format::LandmarkRecord& landmark, const Eigen::Vector3f& position_m) {
    ASSERT_EQ(&landmark, &view->landmarks()[next]);
    ASSERT_EQ(position_m, view->position_m(next));
    ++next;
  });
  EXPECT_EQ(next, 300U);
}

TEST(MapView, Moves) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_map(make_synthetic_map({.seed = 1}), folder.file("a.cmap")).is_ok());
  ASSERT_TRUE(write_map(make_synthetic_map({.num_landmarks = 50, .seed = 2}), folder.file("b.cmap")).is_ok());
  MapView a = MapView::open(folder.file("a.cmap")).value();
  MapView b = MapView::open(folder.file("b.cmap")).value();
  a = std::move(b);
  EXPECT_EQ(a.info().num_landmarks, 50U);
  EXPECT_GT(use_everything(a), 0U);
}

}  // namespace
}  // namespace camloc
