// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bars are as high as their shares, and landmarks have the colour of their distance.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

int count(const ColorImage& image, std::array<std::uint8_t, 3> color) {
  int n = 0;
  for (std::size_t at = 0; at + 2 < image.pixels.size(); at += 3)
    n += image.pixels[at] == color[0] && image.pixels[at + 1] == color[1] && image.pixels[at + 2] == color[2];
  return n;
}

constexpr std::array<std::uint8_t, 3> kBar{70, 120, 170}, kOutside{215, 95, 175};

TEST(EvalPictures, BarsAreAsHighAsTheirShares) {
  CloudDistances one, two;
  one.point_m.assign(100, 0.011F);  // all in one step of 2.5 mm
  two.point_m.assign(50, 0.011F);
  two.point_m.insert(two.point_m.end(), 50, 0.051F);
  // The scale follows the highest bar, so two equal ones cover twice what one does.
  const int single = count(draw_histogram(one, "t"), kBar), both = count(draw_histogram(two, "t"), kBar);
  EXPECT_GT(single, 5000);
  EXPECT_NEAR(static_cast<double>(both) / single, 2, 0.05);
  CloudDistances beyond;
  beyond.point_m.assign(100, 0.3F);
  EXPECT_LT(count(draw_histogram(beyond, "t"), kBar), 100) << "what is beyond the scale has a bar of its own";
  EXPECT_GT(draw_histogram({}, "nothing").width, 0);
}

TEST(EvalPictures, LandmarksOutsideOfTheCloudStandOut) {
  PointCloud cloud;
  Evaluation e;
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 40; ++k) cloud.points_m.emplace_back(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(k), 0.0F);
    e.landmarks_m.emplace_back(0.1 * i, 2, 1);
    e.distances.point_m.push_back(0.01F);
  }
  for (int i = 0; i < 4; ++i) {
    e.T_cloud_keyframe.push_back({Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX())), {1.0 + i, 1, 1.5}});
    e.keyframes_m.push_back(e.T_cloud_keyframe.back().translation);
  }
  for (const CloudView view : {CloudView::kTop, CloudView::kSide}) {
    EXPECT_EQ(count(draw_cloud_view(e, cloud, view, "t"), kOutside), 0);
    Evaluation off = e;
    for (int i = 0; i < 10; ++i) off.distances.point_m[static_cast<std::size_t>(6 * i)] = 0.6F;  // farther than 0.5 m
    EXPECT_GT(count(draw_cloud_view(off, cloud, view, "t"), kOutside), 30);
  }
}

}  // namespace
}  // namespace camloc::mapping
