// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/registration/image_cells.h"

#include <gtest/gtest.h>

namespace camloc {
namespace {

TEST(ImageCells, CountsEachCellOnce) {
  ImageCells cells(640, 480);
  EXPECT_EQ(cells.share(), 0);
  cells.add(10, 10);
  cells.add(79.4F, 79.4F);
  EXPECT_DOUBLE_EQ(cells.share(), 1.0 / 48);
  cells.add(79.6F, 10);  // the border lies between the centres of pixels 79 and 80
  EXPECT_DOUBLE_EQ(cells.share(), 2.0 / 48);
  cells.clear();
  EXPECT_EQ(cells.share(), 0);
}

TEST(ImageCells, AllPixelsFillAllCells) {
  for (const auto& [width, height] :
       {std::pair{640, 480}, std::pair{320, 240}, std::pair{641, 479}, std::pair{8, 6}, std::pair{480, 640}}) {
    ImageCells cells(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) cells.add(static_cast<float>(x), static_cast<float>(y));
    }
    EXPECT_EQ(cells.share(), 1) << width << " x " << height;
  }
}

TEST(ImageCells, PointsOutsideGoToTheRim) {
  ImageCells cells(640, 480);
  cells.add(-50, -50);
  cells.add(0, 0);
  EXPECT_DOUBLE_EQ(cells.share(), 1.0 / 48);
  cells.add(10000, 10000);
  cells.add(639, 479);
  EXPECT_DOUBLE_EQ(cells.share(), 2.0 / 48);
}

}  // namespace
}  // namespace camloc
