// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The picture of a map shows what it should where it should.
#include "tools/mapping/picture/map_picture.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/map/room_map.h"
#include "tests/mapping/lightness.h"

namespace camloc::mapping {
namespace {

using testing::make_room_map;

class MapPictureTest : public ::testing::Test {
 protected:
  MapView open(const MapData& data) {
    const Status written = write_map(data, folder_.file("m.cmap"));
    EXPECT_TRUE(written.is_ok()) << written.message();
    return MapView::open(folder_.file("m.cmap")).value();
  }
  testing::TemporaryFolder folder_;
};

/// Pixels of exactly this colour: how many, and their mean.
struct Blob {
  int count = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
};

Blob find_color(const ColorImage& image, Rgb color, int max_u = 1 << 20) {
  Blob blob;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < std::min(max_u, image.width); ++u) {
      const std::size_t at = 3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u));
      if (image.pixels[at] != color[0] || image.pixels[at + 1] != color[1] || image.pixels[at + 2] != color[2]) continue;
      ++blob.count;
      blob.mean += Eigen::Vector2d(u, v);
    }
  }
  if (blob.count > 0) blob.mean /= blob.count;
  return blob;
}

/// All keyframes are fine but those given.
MapPicture picture_of(const MapView& map, const std::vector<std::uint32_t>& weak, FixOutlook outlook = FixOutlook::kScanAgain) {
  MapPicture picture;
  picture.map = &map;
  picture.places.resize(map.keyframes().size());
  for (const std::uint32_t keyframe : weak) {
    picture.places[keyframe].outlook = outlook;
    picture.places[keyframe].weakness = FixWeakness::kFewLandmarks;
    picture.places[keyframe].rival = RivalPlace{0, 0.5, 100, 90};
    picture.places[keyframe].num_landmarks = 100;
  }
  picture.weak = find_weak_places(map, picture.places, 5);
  return picture;
}

constexpr int kMapPx = 900;  // of a coverage sheet 1600 px wide; right of it is the list

TEST_F(MapPictureTest, CoverageShowsWhereItIsWeak) {
  const MapView map = open(make_room_map());
  const ColorImage fine = draw_map(picture_of(map, {}), MapPanel::kCoverage, 1600);
  EXPECT_EQ(fine.width, 1600);
  EXPECT_GT(find_color(fine, color_of(FixOutlook::kLikely), kMapPx).count, 200);
  EXPECT_EQ(find_color(fine, color_of(FixOutlook::kScanAgain), kMapPx).count, 0);
  EXPECT_EQ(find_color(fine, color_of(FixOutlook::kLookAlike), kMapPx).count, 0);

  // Keyframes go from x = -1 to the right of the room.
  const ColorImage left = draw_map(picture_of(map, {0}), MapPanel::kCoverage, 1600);
  const Blob weak = find_color(left, color_of(FixOutlook::kScanAgain), kMapPx),
             good = find_color(left, color_of(FixOutlook::kLikely), kMapPx);
  EXPECT_GT(weak.count, 30);
  EXPECT_LT(weak.mean.x() + 50, good.mean.x());
  const ColorImage right = draw_map(picture_of(map, {8}, FixOutlook::kLookAlike), MapPanel::kCoverage, 1600);
  EXPECT_GT(find_color(right, color_of(FixOutlook::kLookAlike), kMapPx).mean.x(),
            find_color(right, color_of(FixOutlook::kLikely), kMapPx).mean.x() + 50);
}

TEST_F(MapPictureTest, AWedgeOpensTheWayTheCameraLooks) {
  MapData room = make_room_map({.num_keyframes = 2});
  room.keyframes[0].T_map_camera = testing::looking({0, 0, 1.5}, {1, 0, 0});
  room.keyframes[1].T_map_camera = testing::looking({0, 0, 1.5}, {0, 1, 0});
  const MapView map = open(room);
  MapPicture ahead = picture_of(map, {0}), aside = picture_of(map, {1});
  ahead.weak.clear();  // no number over the wedge
  aside.weak.clear();
  const Blob right = find_color(draw_map(ahead, MapPanel::kCoverage, 1600), color_of(FixOutlook::kScanAgain), kMapPx);
  const Blob up = find_color(draw_map(aside, MapPanel::kCoverage, 1600), color_of(FixOutlook::kScanAgain), kMapPx);
  EXPECT_GT(right.mean.x(), up.mean.x() + 5);  // x goes to the right
  EXPECT_LT(up.mean.y(), right.mean.y() - 5);  // y goes up
}

TEST_F(MapPictureTest, ColorsCanBeToldApartInGrey) {
  const double likely = lightness_of(color_of(FixOutlook::kLikely)), again = lightness_of(color_of(FixOutlook::kScanAgain));
  EXPECT_GT(std::abs(likely - again), 30);
  EXPECT_GT(std::abs(lightness_of(color_of(FixOutlook::kLookAlike)) - again), 30);
}

TEST_F(MapPictureTest, EveryPanelIsDrawnInEveryWidth) {
  const MapView map = open(make_room_map());
  for (const MapPanel panel : {MapPanel::kTop, MapPanel::kPerspective, MapPanel::kCoverage, MapPanel::kAll}) {
    for (const int width : {400, 801, 1600}) {
      const ColorImage image = draw_map(picture_of(map, {0, 4, 8}), panel, width);
      EXPECT_EQ(image.width, width);
      EXPECT_EQ(image.pixels.size(), 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
      EXPECT_GT(find_color(image, {252, 252, 250}).count, image.width * image.height / 4);
    }
  }
}

TEST_F(MapPictureTest, AFarLandmarkDoesNotShrinkTheRoom) {
  MapData room = make_room_map();
  const Blob before = find_color(draw_map(picture_of(open(room), {}), MapPanel::kCoverage, 1600), color_of(FixOutlook::kLikely), kMapPx);
  room.landmarks[0].position_m = {400, 300, 1};
  const Blob after = find_color(draw_map(picture_of(open(room), {}), MapPanel::kCoverage, 1600), color_of(FixOutlook::kLikely), kMapPx);
  EXPECT_NEAR(after.mean.x(), before.mean.x(), 20);
  EXPECT_NEAR(after.mean.y(), before.mean.y(), 20);
}

TEST_F(MapPictureTest, AWalkIsDrawnAndItsBareStretchesStandOut) {
  const MapView map = open(make_room_map());
  MapPicture picture = picture_of(map, {});
  for (int i = 0; i <= 20; ++i) picture.trajectory.push_back({Eigen::Quaterniond::Identity(), {-1 + 0.08 * i, 0, 1.5}});
  const ColorImage near = draw_map(picture, MapPanel::kCoverage, 1600);
  EXPECT_EQ(find_color(near, color_of(FixOutlook::kScanAgain), kMapPx).count, 0);
  picture.trajectory.clear();
  for (int i = 0; i <= 40; ++i) picture.trajectory.push_back({Eigen::Quaterniond::Identity(), {-1 - 0.1 * i, 0, 1.5}});
  const ColorImage far = draw_map(picture, MapPanel::kCoverage, 1600);
  EXPECT_GT(find_color(far, color_of(FixOutlook::kScanAgain), kMapPx).count, 100);
}

}  // namespace
}  // namespace camloc::mapping
