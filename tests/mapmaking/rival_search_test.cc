// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map finds out by itself which of its bays are alike, and what tells them apart.
#include "core/mapmaking/rival_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "core/map/map_unpack.h"
#include "tests/base/recording_observer.h"
#include "tests/mapmaking/bay_map.h"

namespace camloc {
namespace {

using testing::make_corridor;
using testing::one_view_a_bay;

/// On disk, with its look-alikes.
struct Upgraded {
  explicit Upgraded(MapData map, const std::vector<Rigid3>& poses) {
    testing::set_keyframes(&map, poses);
    EXPECT_TRUE(write_map(map, folder.file("a.cmap")).is_ok());
    const auto plain = MapView::open(folder.file("a.cmap"));
    EXPECT_TRUE(plain.is_ok());
    data = unpack_map(*plain);
    testing::RecordingObserver observer;
    EXPECT_TRUE(add_look_alikes(*plain, &data, observer));
    EXPECT_EQ(observer.count("look-alikes, keyframe"), data.keyframes.size());
    EXPECT_TRUE(write_map(data, folder.file("b.cmap")).is_ok());
    auto opened = MapView::open(folder.file("b.cmap"));
    EXPECT_TRUE(opened.is_ok()) << opened.status().message();
    view = std::make_unique<MapView>(std::move(opened).value());
  }
  [[nodiscard]] double repeated_share(const std::function<bool(const Eigen::Vector3f&)>& is_wanted) const {
    const LookAlikes look_alikes(*view);
    int num_repeated = 0, num_wanted = 0;
    for (std::uint32_t i = 0; i < view->landmarks().size(); ++i) {
      if (!is_wanted(view->position_m(i))) continue;
      ++num_wanted;
      num_repeated += look_alikes.is_repeated(i) ? 1 : 0;
    }
    return static_cast<double>(num_repeated) / num_wanted;
  }
  testing::TemporaryFolder folder;
  MapData data;
  std::unique_ptr<MapView> view;
};

/// Of the one keyframe of its bay.
bool is_in_view(const Eigen::Vector3f& p) { return std::abs(std::fmod(p.x(), 4.0F) - 2) < 1.2F && p.z() > 0.5F && p.z() < 2.1F; }

TEST(RivalSearch, IdenticalBaysNameEachOtherAndTheirLandmarks) {
  const Upgraded corridor(make_corridor(4, 12), one_view_a_bay(4));
  const LookAlikes look_alikes(*corridor.view);
  ASSERT_TRUE(look_alikes.is_known());
  for (std::uint32_t k = 0; k < 4; ++k) {
    ASSERT_EQ(look_alikes.num_rivals(k), 3U) << k;
    for (std::size_t i = 0; i < 3; ++i) {
      const RivalPose rival = look_alikes.rival(k, i);
      EXPECT_NE(rival.keyframe, k);
      const Rigid3 there = corridor.view->keyframe_pose(rival.keyframe);
      EXPECT_LT((rival.T_map_camera.translation - there.translation).norm(), 0.02);
      EXPECT_LT(rotation_distance_rad(rival.T_map_camera.rotation, there.rotation), 0.01);
    }
  }
  EXPECT_GT(corridor.repeated_share(is_in_view), 0.9);
}

TEST(RivalSearch, DifferentBaysDoNot) {
  const Upgraded corridor(make_corridor(4, 400), one_view_a_bay(4));
  const LookAlikes look_alikes(*corridor.view);
  EXPECT_TRUE(look_alikes.is_known()) << "it is known that there are none";
  for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(look_alikes.num_rivals(k), 0U);
  EXPECT_EQ(corridor.repeated_share([](const Eigen::Vector3f&) { return true; }), 0);
}

TEST(RivalSearch, APosterIsNotRepeated) {
  MapData map = make_corridor(2, 12);
  testing::Random random(3);
  const auto is_on_poster = [](const Eigen::Vector3f& p) { return std::abs(p.x() - 2) < 0.5F && std::abs(p.z() - 1.4F) < 0.4F; };
  std::erase_if(map.landmarks, [&](const MapLandmark& landmark) { return is_on_poster(landmark.position_m); });
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d p(random.uniform(1.55, 2.45), 2, random.uniform(1.05, 1.75));
    map.landmarks.push_back(testing::room_landmark(p, Eigen::Vector3d(2, -0.5, 1.4) - p, &random));
  }
  const Upgraded corridor(map, one_view_a_bay(2));
  EXPECT_LT(corridor.repeated_share(is_on_poster), 0.1);
  const auto is_beside_it = [](const Eigen::Vector3f& p) {
    const bool is_near = std::abs(std::fmod(p.x(), 4.0F) - 2) < 0.7F && std::abs(p.z() - 1.4F) < 0.6F;
    return is_in_view(p) && !is_near;
  };
  EXPECT_GT(corridor.repeated_share(is_beside_it), 0.8);
}

TEST(RivalSearch, StopsWhenAskedToAndLeavesTheMapAlone) {
  MapData map = make_corridor(2, 12);
  testing::set_keyframes(&map, one_view_a_bay(2));
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(write_map(map, folder.file("a.cmap")).is_ok());
  const auto view = MapView::open(folder.file("a.cmap"));
  ASSERT_TRUE(view.is_ok());
  MapData data = unpack_map(*view);
  testing::RecordingObserver observer(0);
  EXPECT_FALSE(add_look_alikes(*view, &data, observer));
  EXPECT_TRUE(data.extra_sections.empty());
}

}  // namespace
}  // namespace camloc
