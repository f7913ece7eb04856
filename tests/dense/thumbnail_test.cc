// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/dense/thumbnail.h"

#include <gtest/gtest.h>

#include <cmath>

namespace camloc {
namespace {

RgbdCamera registered_camera() {
  RgbdCamera camera;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 525;
  camera.color.cx = 319.5;
  camera.color.cy = 239.5;
  camera.depth = camera.color;
  return camera;
}

struct Images {
  Image<std::uint8_t> gray;
  Image<std::uint16_t> depth;

  Images() {
    gray.resize(640, 480);
    depth.resize(640, 480);
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) {
        gray.at(x, y) = static_cast<std::uint8_t>(x / 8 + (x + y) % 2);
        depth.at(x, y) = 2000;
      }
    }
  }
  [[nodiscard]] Frame frame() const { return {0, 0, gray.view(), depth.view()}; }
};

double depth_m(const Thumbnail& view, int x, int y) { return view.depth[view.index(x, y)] * static_cast<double>(Thumbnail::kDepthUnitM); }

TEST(Thumbnail, AveragesGreyAndTakesTheNearerSurface) {
  Images images;
  for (int y = 0; y < 480; ++y) {
    for (int x = 324; x < 328; ++x) images.depth.at(x, y) = 1000;  // half of a cell
    for (int x = 400; x < 416; ++x) images.depth.at(x, y) = 0;
  }
  const Thumbnail view = ThumbnailMaker(registered_camera()).make(images.frame());
  EXPECT_EQ(view.width, 80);
  EXPECT_EQ(view.height, 60);
  EXPECT_EQ(view.cell_px, 8);
  EXPECT_NEAR(view.grey[view.index(30, 7)] * static_cast<double>(Thumbnail::kGreyUnit), 30.5, 0.02);
  EXPECT_NEAR(depth_m(view, 10, 20), 2.0, 1e-3);
  EXPECT_NEAR(depth_m(view, 40, 20), 1.0, 1e-3);
  EXPECT_EQ(view.depth[view.index(50, 20)], 0);
}

// A floor seen at a grazing angle: a mean of depths would lie behind it, one that drops the far end of a cell before it.
TEST(Thumbnail, ASlantedPlaneHasTheDepthOfTheMiddleOfACell) {
  RgbdCamera camera = registered_camera();
  camera.depth_unit_m = 0.0001;
  const auto plane = [&](double x, double y) { return 1.0 / (0.002 * (y - 200) + 0.0001 * x); };
  Images images;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const double z = plane(x, y);
      images.depth.at(x, y) = z > 0.5 && z < 5 ? static_cast<std::uint16_t>(std::lround(z / 0.0001)) : std::uint16_t{0};
    }
  }
  const Thumbnail view = ThumbnailMaker(camera).make(images.frame());
  int num_checked = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const double z = plane(8 * x + 3.5, 8 * y + 3.5);
      if (!(z > 0.6 && z < 4)) continue;
      EXPECT_NEAR(depth_m(view, x, y), z, 0.0004) << x << " " << y;
      ++num_checked;
    }
  }
  EXPECT_GT(num_checked, 1000);
}

// The depth camera sits 10 cm to the left and has another focal length: what is near moves farther.
TEST(Thumbnail, ProjectsDepthThatIsNotRegistered) {
  RgbdCamera camera = registered_camera();
  camera.is_depth_registered = false;
  camera.depth.fx = camera.depth.fy = 585;
  camera.T_color_depth.translation.x() = -0.1;
  Images images;
  for (int y = 0; y < 480; ++y) {
    for (int x = 300; x < 400; ++x) images.depth.at(x, y) = 1000;
  }
  const Thumbnail view = ThumbnailMaker(camera).make(images.frame());
  const auto column_of = [&](double depth_x, double z) {
    return static_cast<int>(std::floor((525 * ((depth_x - 319.5) / 585 - 0.1 / z) + 320) / 8));
  };
  EXPECT_NEAR(depth_m(view, column_of(350, 1.0), 30), 1.0, 1e-3);
  EXPECT_NEAR(depth_m(view, column_of(500, 2.0), 30), 2.0, 1e-3);
  EXPECT_NEAR(depth_m(view, column_of(304, 1.0), 30), 1.0, 1e-3);  // hides what the depth camera saw behind
}

}  // namespace
}  // namespace camloc
