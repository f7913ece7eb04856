// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A flat of two rooms with furniture, scanned every 3 cm with 2 mm noise, and landmarks on its surfaces.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tests/map/synthetic_map.h"

namespace camloc::mapping {

using testing::Random;

struct ScannedFlat {
  std::vector<Eigen::Vector3f> cloud_m;
  std::vector<Eigen::Vector3d> landmarks_m;  ///< exactly on surfaces, in the frame of the cloud

  /// Rooms of 8 x 5 x 2.6 m and 3 x 4 x 2.6 m with tables and cupboards: no way to lay it onto itself but one.
  explicit ScannedFlat(int seed) {
    Random random(static_cast<std::uint32_t>(seed));
    add_box({0, 0, 0}, {8, 5, 2.6}, &random);
    add_box({8.2, 0, 0}, {3, 4, 2.6}, &random);
    add_box({1, 0, 0}, {1.8, 0.8, 0.75}, &random);
    add_box({6.5, 4.4, 0}, {1.2, 0.6, 2.0}, &random);
    add_box({0, 3, 0}, {0.5, 1.5, 1.2}, &random);
    add_box({10, 1, 0}, {1, 0.8, 0.75}, &random);
  }

 private:
  void add_box(const Eigen::Vector3d& low, const Eigen::Vector3d& size, Random* random) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const double side : {0.0, 1.0}) {
        for (double a = 0; a <= size[u]; a += 0.03) {
          for (double b = 0; b <= size[v]; b += 0.03) add_sample(low, size, axis, side, a, b, random);
        }
      }
    }
  }

  void add_sample(const Eigen::Vector3d& low, const Eigen::Vector3d& size, int axis, double side, double a, double b, Random* random) {
    Eigen::Vector3d p = low;
    p[axis] += side * size[axis];
    p[(axis + 1) % 3] += a;
    p[(axis + 2) % 3] += b;
    const Eigen::Vector3d noise(random->uniform(-1, 1), random->uniform(-1, 1), random->uniform(-1, 1));
    cloud_m.push_back((p + 0.0035 * noise).cast<float>());  // 2 mm standard deviation
    if (random->below(40) != 0) return;
    Eigen::Vector3d landmark = p;
    landmark[(axis + 1) % 3] += random->uniform(-0.015, 0.015);
    landmark[(axis + 2) % 3] += random->uniform(-0.015, 0.015);
    landmarks_m.push_back(landmark);
  }
};

}  // namespace camloc::mapping
