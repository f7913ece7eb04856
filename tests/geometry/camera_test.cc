// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Camera models against OpenCV's, against differences, and there and back again over whole images.
#include "core/geometry/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/calib3d.hpp>

#include "tests/geometry/generated.h"

namespace camloc {
namespace {

Intrinsics tum_fr1() {
  return {640, 480, 517.3, 516.5, 318.6, 255.3, LensModel::kBrownConrady, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
}

/// Of the Azure Kinect's kind: the polynomials nearly cancel.
Intrinsics rational() {
  return {640, 480, 303.5, 303.4, 319, 243, LensModel::kRational, {0.52, -2.71, 0.0006, -0.0001, 1.58, 0.40, -2.54, 1.51}};
}

Intrinsics wide_lens() { return {640, 480, 340, 341, 322, 238, LensModel::kEquidistant, {-0.01, 0.02, -0.008, 0.001, 0}}; }

Intrinsics pinhole() { return {640, 480, 525, 525, 319.5, 239.5, LensModel::kPinhole, {}}; }

/// Strong barrel distortion: folds over inside the image.
Intrinsics folding() { return {640, 480, 300, 300, 320, 240, LensModel::kBrownConrady, {-0.4, 0, 0, 0, 0}}; }

cv::Matx33d matrix_of(const Intrinsics& c) { return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}; }

TEST(Camera, ProjectsLikeOpenCv) {
  std::mt19937 rng(1);
  for (const Intrinsics& camera : {pinhole(), tum_fr1(), wide_lens(), rational()}) {
    std::vector<cv::Point3d> points;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d p = testing::random_vector(rng, 1);
      const double z = 2.5 + std::abs(p.z());
      points.emplace_back(p.x(), p.y(), z);
    }
    const cv::Vec3d zero(0, 0, 0);
    std::vector<cv::Point2d> expected;
    if (camera.lens == LensModel::kEquidistant) {
      const cv::Vec4d k(camera.distortion[0], camera.distortion[1], camera.distortion[2], camera.distortion[3]);
      cv::fisheye::projectPoints(points, expected, zero, zero, matrix_of(camera), k);
    } else {
      cv::projectPoints(points, zero, zero, matrix_of(camera), std::vector<double>(camera.distortion.begin(), camera.distortion.end()),
                        expected);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d pixel = camera.project({points[i].x, points[i].y, points[i].z});
      EXPECT_NEAR(pixel.x(), expected[i].x, 1e-9);
      EXPECT_NEAR(pixel.y(), expected[i].y, 1e-9);
    }
  }
}

TEST(Camera, UndistortsLikeOpenCv) {
  const Intrinsics camera = tum_fr1();
  std::vector<cv::Point2d> pixels, expected;
  for (int v = 0; v < 480; v += 20) {
    for (int u = 0; u < 640; u += 20) pixels.emplace_back(u, v);
  }
  cv::undistortPoints(pixels, expected, matrix_of(camera), std::vector<double>(camera.distortion.begin(), camera.distortion.end()),
                      cv::noArray(), cv::noArray(), cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-14));
  int num_compared = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    // OpenCV's own iteration does not converge everywhere in the corners: compare where it did.
    const Eigen::Vector2d theirs(expected[i].x, expected[i].y), pixel(pixels[i].x, pixels[i].y);
    if ((camera.distort(theirs) - pixel).norm() > 1e-6) continue;
    ++num_compared;
    EXPECT_LT((camera.undistort(pixel) - theirs).norm(), 1e-8) << pixel.transpose();
  }
  EXPECT_GT(num_compared, 700);
}

TEST(Camera, RationalLensIsUndistortedAsTheKinectsOwn) {
  const Intrinsics camera{
      1280, 720, 607.1, 606.9, 638.2, 366.4, LensModel::kRational, {0.52, -2.71, 0.0006, -0.0001, 1.58, 0.40, -2.54, 1.51}};
  const Eigen::Vector2d ray = camera.undistort({1200, 100});  // cv::undistortPoints says so
  EXPECT_NEAR(ray.x(), 0.8788, 1e-3);
  EXPECT_NEAR(ray.y(), -0.4173, 1e-3);
}

TEST(Camera, EveryPixelComesBack) {
  for (const Intrinsics& camera : {pinhole(), tum_fr1(), wide_lens(), rational()}) {
    for (int v = 0; v < 480; v += 7) {
      for (int u = 0; u < 640; u += 7) {
        const Eigen::Vector2d pixel(u, v);
        EXPECT_LT((camera.distort(camera.undistort(pixel)) - pixel).norm(), 1e-6) << pixel.transpose();
        EXPECT_TRUE(camera.is_invertible_at(pixel)) << pixel.transpose();
      }
    }
  }
}

TEST(Camera, UndistortionStaysOnTheBranchThroughTheCentre) {
  const Intrinsics camera = tum_fr1();
  for (int v = 0; v < 480; v += 16) {
    Eigen::Vector2d last = camera.undistort({0, v});
    for (int u = 1; u < 640; ++u) {
      const Eigen::Vector2d here = camera.undistort(Eigen::Vector2d(u, v));
      EXPECT_LT((here - last).norm(), 3.0 / 517) << "jump at " << u << ' ' << v;
      last = here;
    }
  }
}

TEST(Camera, SaysWhereTheModelFolds) {
  const Intrinsics camera = folding();
  // r (1 - 0.4 r^2) has its maximum 0.6086 at r = 0.9129: 182.6 px from the centre.
  EXPECT_TRUE(camera.is_invertible_at({320, 240}));
  EXPECT_TRUE(camera.is_invertible_at({320 + 175, 240}));
  EXPECT_FALSE(camera.is_invertible_at({320 + 190, 240}));
  EXPECT_FALSE(camera.is_invertible_at({0, 0}));
  for (int u = 0; u < 640; u += 5) EXPECT_TRUE(camera.undistort(Eigen::Vector2d(u, 0)).allFinite());
}

TEST(Camera, UndistortionTableIsNearTheModel) {
  for (const Intrinsics& camera : {pinhole(), tum_fr1(), wide_lens(), rational()}) {
    const UndistortionTable table(camera);
    double worst_px = 0;
    for (double v = 0; v <= 479; v += 3.3) {
      for (double u = 0; u <= 639; u += 3.3) {
        const Eigen::Vector2d exact = camera.undistort({u, v});
        const Eigen::Vector2d looked_up = table.undistort(static_cast<float>(u), static_cast<float>(v)).cast<double>();
        worst_px = std::max(worst_px, (camera.distort(looked_up) - camera.distort(exact)).norm());
      }
    }
    // The worst is in the extreme corners; the tangent makes a wide lens steep there.
    EXPECT_LT(worst_px, camera.lens == LensModel::kEquidistant ? 0.15 : 0.05);
  }
}

TEST(Camera, UndistortionTableWorksForTinyImages) {
  Intrinsics camera = pinhole();
  camera.width = 640;
  camera.height = 1;
  const UndistortionTable table(camera);
  const Eigen::Vector2f expected = camera.undistort({600, 0}).cast<float>();
  EXPECT_LT((table.undistort(600, 0) - expected).norm(), 1e-6F);
}

void expect_refused(const Intrinsics& camera, const std::string& key) {
  const Status status = camera.validate();
  EXPECT_FALSE(status.is_ok()) << key;
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_EQ(status.message().rfind(key, 0), 0U) << status.message();
  EXPECT_NE(status.message().find("not allowed: "), std::string::npos) << status.message();
}

TEST(Camera, RefusesBadIntrinsicsByName) {
  EXPECT_TRUE(tum_fr1().validate().is_ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto member, auto value) {
    Intrinsics camera = tum_fr1();
    camera.*member = value;
    return camera;
  };
  expect_refused(with(&Intrinsics::width, 0), "width");
  expect_refused(with(&Intrinsics::width, 16385), "width");
  expect_refused(with(&Intrinsics::height, -1), "height");
  expect_refused(with(&Intrinsics::fx, 0.0), "fx");
  expect_refused(with(&Intrinsics::fx, nan), "fx");
  expect_refused(with(&Intrinsics::fy, -525.0), "fy");
  expect_refused(with(&Intrinsics::fy, 1e9), "fy");
  expect_refused(with(&Intrinsics::cx, nan), "cx");
  expect_refused(with(&Intrinsics::cx, 1e5), "cx");
  expect_refused(with(&Intrinsics::cy, -1e5), "cy");
  expect_refused(with(&Intrinsics::distortion, std::array<double, 8>{0, nan, 0, 0, 0}), "distortion");
}

TEST(Camera, RefusesBadRigsByName) {
  const auto refused = [](const RgbdCamera& camera, const std::string& text) {
    const Status status = camera.validate();
    EXPECT_FALSE(status.is_ok()) << text;
    EXPECT_NE(status.message().find(text), std::string::npos) << status.message();
  };
  RgbdCamera good;
  good.color = good.depth = pinhole();
  EXPECT_TRUE(good.validate().is_ok()) << good.validate().message();
  RgbdCamera bad = good;
  bad.color.fx = -1;
  refused(bad, "color: fx");
  bad = good;
  bad.depth.height = 240;
  refused(bad, "is_depth_registered");
  bad = good;
  bad.T_color_depth.translation.x() = 25;
  refused(bad, "T_color_depth translation");
  bad = good;
  bad.T_color_depth.rotation.coeffs() *= 2;
  refused(bad, "T_color_depth rotation");
  bad = good;
  bad.depth_unit_m = 0;
  refused(bad, "depth_unit_m");
  bad = good;
  bad.max_depth_m = bad.min_depth_m;
  refused(bad, "max_depth_m");
  bad = good;
  bad.min_depth_m = -1;
  refused(bad, "min_depth_m");
  bad = good;
  bad.depth_noise.quadratic_per_m = std::numeric_limits<double>::infinity();
  refused(bad, "depth_noise.quadratic_per_m");
}

TEST(Camera, ConvertsRawDepth) {
  RgbdCamera camera;
  camera.depth_unit_m = 0.0002;
  EXPECT_EQ(camera.depth_m(0), 0.0F);
  EXPECT_EQ(camera.depth_m(65535), 0.0F);
  EXPECT_FLOAT_EQ(camera.depth_m(5000), 1.0F);
  EXPECT_EQ(camera.depth_m(1000), 0.0F) << "nearer than min_depth_m";
  EXPECT_EQ(camera.depth_m(45000), 0.0F) << "farther than max_depth_m";
}

}  // namespace
}  // namespace camloc
