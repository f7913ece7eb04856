// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The motion between two frames from all their pixels at once: grey levels and depth of one are compared with those of the other
// where a motion would put them (Kerl, Sturm, Cremers, "Dense visual SLAM for RGB-D cameras", 2013). On thumbnails this takes a few
// milliseconds; it needs a good guess, and serves where there is no feature to hold on to.
#pragma once

#include <cstddef>
#include <vector>

#include "core/dense/thumbnail.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace camloc {

struct DenseAlignment {
  bool is_aligned = false;
  Rigid3 T_a_b;
  Matrix6d covariance = Matrix6d::Identity();  ///< of pose_error() of T_a_b (metres then radians, axes of a)
  double overlap = 0, inlier_share = 0;
};

/// Not thread-safe. The same input gives the same bits.
class DenseAligner {
 public:
  explicit DenseAligner(const RgbdCamera& camera) : camera_(camera) {}

  /// Starts at the prediction, which is a measurement like any other: directions that the frames say nothing about, as along a
  /// bare wall, stay as predicted, with the covariance of the prediction (that of pose_error(), axes of a).
  [[nodiscard]] DenseAlignment align(const Thumbnail& a, const Thumbnail& b, const Rigid3& T_a_b_predicted, const Matrix6d& covariance);

 private:
  struct Equations {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    double overlap = 0, inlier_share = 0;
  };
  void prepare(const Thumbnail& b);
  [[nodiscard]] Equations linearize(const Thumbnail& a, const Thumbnail& b, const Rigid3& T_a_b);

  struct Point {
    Eigen::Vector3d p_b;
    float grey;
  };
  struct Pair {
    Vector6d J_grey, J_depth;
    double grey, depth, depth_sigma, slope_squared;  ///< depth: inverse, 1 / m
  };
  RgbdCamera camera_;
  std::vector<float> grey_a_, grey_b_;     ///< without slow changes
  std::vector<float> inverse_a_;           ///< of the depth, 1 / m
  std::vector<Eigen::Vector2f> slopes_a_;  ///< of that, a cell
  std::vector<Point> points_;
  std::vector<Pair> pairs_;
};

}  // namespace camloc
