// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of a room, or of a photograph of it on a sheet, before a camera that moves. The poses are what the refinement makes of them.
#include "core/localize/motion_parallax.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/geometry/pose_refinement.h"

namespace camloc {
namespace {

constexpr double kFocalPx = 525;
constexpr double kSigmaPx = 0.7;
constexpr std::int64_t kFrameNs = 33'333'333;

/// 150 points between 1.5 and 4 m before the origin; on a wall at 3 m where `is_flat`.
std::vector<Eigen::Vector3d> points_before(bool is_flat) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> across(-0.5, 0.5), depth(1.5, 4.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 150; ++i) {
    const double z = is_flat ? 3 : depth(random);
    points.emplace_back(across(random) * z, 0.7 * across(random) * z, z);
  }
  return points;
}

Rigid3 camera_at(double x_m) { return {exp_so3({0.01 * x_m, -0.2 * x_m, 0}), {x_m, 0.3 * x_m, 0.1 * x_m}}; }

Eigen::Vector2d projected(const Rigid3& T_map_camera, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d p = T_map_camera.inverse() * p_map;
  return p.head<2>() / p.z();
}

struct Frame {
  Rigid3 T_map_camera;
  std::vector<LandmarkSighting> sightings;
};

class View {
 public:
  explicit View(bool is_flat = false) : points_(points_before(is_flat)) {}

  /// The room from there.
  Frame of_room(double x_m) {
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector3d& p : points_) seen.push_back(projected(camera_at(x_m), p));
    return sightings(seen, camera_at(x_m));
  }
  /// A photograph of it that was taken at the origin and hangs 2 m away, filling the image as the room would.
  Frame of_photograph(double x_m) {
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector3d& p : points_)
      seen.push_back(projected(camera_at(x_m), 2 * Eigen::Vector3d(p.x() / p.z(), p.y() / p.z(), 1)));
    return sightings(seen, camera_at(x_m));
  }

 private:
  Frame sightings(const std::vector<Eigen::Vector2d>& seen, const Rigid3& T_map_camera_start) {
    std::normal_distribution<double> noise(0, kSigmaPx / kFocalPx);
    std::vector<LandmarkSighting> result;
    Correspondences pairs(seen.size());
    for (std::uint32_t i = 0; i < seen.size(); ++i) {
      result.push_back({i, seen[i] + Eigen::Vector2d(noise(random_), noise(random_)), 0, kSigmaPx / kFocalPx});
      const Eigen::Vector3f p = points_[i].cast<float>();
      const Eigen::Vector2f at = result.back().seen.cast<float>();
      pairs.add(at.x(), at.y(), p.x(), p.y(), p.z(), 0, 1, 0, static_cast<std::int32_t>(i), static_cast<std::int32_t>(i));
    }
    PoseRefinementOptions options;
    options.use_depth = false;
    const PoseRefinementResult pose = refine_pose(pairs, T_map_camera_start, kFocalPx, options, nullptr);
    for (LandmarkSighting& sighting : result) sighting.depth_m = (pose.T_map_camera.inverse() * points_[sighting.landmark]).z();
    return {pose.T_map_camera, result};
  }

  std::vector<Eigen::Vector3d> points_;
  std::mt19937_64 random_{5};
};

/// The frame, of 60 in which the camera moves 1 cm each, that shows it is no plane; 60 where none does.
int shown_after(const std::function<Frame(double)>& view) {
  MotionParallax parallax{MotionParallaxOptions{}};
  for (int i = 0; i < 60; ++i) {
    Frame frame = view(0.01 * i);
    if (parallax.add(i * kFrameNs, frame.T_map_camera, frame.sightings)) return i;
  }
  return 60;
}

TEST(MotionParallax, AFewCentimetresInARoomAreEnough) {
  View view;
  const int frame = shown_after([&](double x_m) { return view.of_room(x_m); });
  EXPECT_GE(frame, 1);
  EXPECT_LE(frame, 12);
}

TEST(MotionParallax, APhotographIsFlatHoweverTheCameraMoves) {
  View view;
  EXPECT_EQ(shown_after([&](double x_m) { return view.of_photograph(x_m); }), 60);
}

TEST(MotionParallax, AWallShowsNothing) {
  View view(true);
  EXPECT_EQ(shown_after([&](double x_m) { return view.of_room(x_m); }), 60);
}

TEST(MotionParallax, StandingStillShowsNothing) {
  View view;
  EXPECT_EQ(shown_after([&](double) { return view.of_room(0.1); }), 60);
}

TEST(MotionParallax, TurningShowsNothing) {
  const auto points = points_before(false);
  EXPECT_EQ(shown_after([&](double angle_rad) {
              const Rigid3 T_map_camera{exp_so3({0, angle_rad / 4, 0}), Eigen::Vector3d::Zero()};
              std::vector<LandmarkSighting> sightings;
              for (std::uint32_t i = 0; i < points.size(); ++i) {
                const Eigen::Vector2d at = projected(T_map_camera, points[i]);
                sightings.push_back({i, at, (T_map_camera.inverse() * points[i]).z(), kSigmaPx / kFocalPx});
              }
              return Frame{T_map_camera, sightings};
            }),
            60);
}

bool add(MotionParallax* parallax, std::int64_t stamp_ns, Frame frame) {
  return parallax->add(stamp_ns, frame.T_map_camera, frame.sightings);
}

TEST(MotionParallax, FramesFarApartInTimeAreNotCompared) {
  View view;
  MotionParallax parallax{MotionParallaxOptions{}};
  EXPECT_FALSE(add(&parallax, 0, view.of_room(0)));
  EXPECT_FALSE(add(&parallax, 6'000'000'000, view.of_room(0.3)));
  EXPECT_TRUE(add(&parallax, 7'000'000'000, view.of_room(0.6))) << "the second began anew";
  parallax.reset();
  EXPECT_FALSE(add(&parallax, 7'100'000'000, view.of_room(0.3)));
  EXPECT_EQ(parallax.evidence(), 0);
}

TEST(MotionParallax, NeedsLandmarksThatBothFramesShow) {
  View view;
  MotionParallax parallax{MotionParallaxOptions{}};
  Frame second = view.of_room(0.3);
  for (LandmarkSighting& sighting : second.sightings) sighting.landmark += 121;  // 29 are left
  EXPECT_FALSE(add(&parallax, 0, view.of_room(0)));
  EXPECT_FALSE(add(&parallax, kFrameNs, second));
  EXPECT_EQ(parallax.evidence(), 0);
}

}  // namespace
}  // namespace camloc
