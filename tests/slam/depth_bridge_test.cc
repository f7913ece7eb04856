// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A pan across a wall that has no features, followed by thumbnails alone.
#include "core/slam/depth_bridge.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/dense/generated_thumbnail.h"
#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

using testing::BoxRenderer;
using testing::looking;

constexpr std::int64_t kFrameNs = 100'000'000;

Rigid3 pan(double frame) { return looking({1.7 + 0.003 * frame, 0.012 * frame, 1.4 - 0.001 * frame}, -0.5 + 0.07 * frame, -0.004 * frame); }

/// A bridge with a renderer; the expectation is constant velocity from the last two poses, as the tracker has it.
struct Scenery {
  testing::World world;
  testing::Viewer viewer{world};
  BoxRenderer renderer{viewer.camera(), {-3, -2.5, 0}, {3, 2.5, 2.8}};
  DepthBridge bridge{viewer.camera(), {}};
  Rigid3 T_begin_before = pan(0).inverse() * pan(-1), T_begin_last;

  Scenery() { begin(); }
  void begin() { bridge.begin_at(0, renderer.see(pan(0))); }
  std::optional<DepthBridge::Step> step(int frame, std::int64_t stamp_ns) {
    const Rigid3 T_last_next = T_begin_before.inverse() * T_begin_last;
    const auto step = bridge.step(stamp_ns, renderer.see(pan(frame)), T_begin_last * T_last_next);
    if (step) {
      T_begin_before = T_begin_last;
      T_begin_last = step->T_begin_camera;
    }
    return step;
  }
};

TEST(DepthBridge, FollowsAPanAcrossAWall) {
  Scenery scenery;
  EXPECT_FALSE(scenery.bridge.is_open());
  std::optional<DepthBridge::Step> last;
  for (int frame = 1; frame <= 14; ++frame) {
    last = scenery.step(frame, frame * kFrameNs);
    ASSERT_TRUE(last.has_value()) << frame;
  }
  EXPECT_TRUE(scenery.bridge.is_open());
  const Vector6d error = pose_error(pan(0).inverse() * pan(14), last->T_begin_camera);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.012);
  EXPECT_LT(error.dot(last->covariance.inverse() * error), 40);  // 6 degrees of freedom
}

TEST(DepthBridge, EndsWhereTheStampsHaveAGap) {
  Scenery scenery;
  ASSERT_TRUE(scenery.step(1, kFrameNs));
  EXPECT_FALSE(scenery.step(2, 6 * kFrameNs));
  EXPECT_FALSE(scenery.bridge.is_open());
  EXPECT_FALSE(scenery.step(3, 7 * kFrameNs));  // and there is none until a view is tracked again
}

// Without texture nothing says where along the wall the camera is, and the covariance knows.
TEST(DepthBridge, KnowsLessWithoutTexture) {
  const auto sigma_m = [](double contrast) {
    Scenery scenery;
    scenery.renderer.contrast = contrast;
    scenery.begin();
    std::optional<DepthBridge::Step> last;
    for (int frame = 1; frame <= 5; ++frame) last = scenery.step(frame, frame * kFrameNs);
    return last ? std::sqrt(last->covariance.topLeftCorner<3, 3>().trace()) : 1e9;
  };
  EXPECT_LT(sigma_m(0.3), 0.006);
  EXPECT_GT(sigma_m(0), 0.010);
}

TEST(DepthBridge, EndsWhenTooLittleIsKnown) {
  Scenery scenery;
  SlamNumbers numbers;
  numbers.bridge_max_sigma_m = 0.008;
  scenery.bridge = DepthBridge(scenery.viewer.camera(), numbers);
  scenery.renderer.contrast = 0;
  scenery.begin();
  int frame = 1;
  while (frame <= 10 && scenery.step(frame, frame * kFrameNs)) ++frame;
  EXPECT_LT(frame, 6);
  EXPECT_FALSE(scenery.bridge.is_open());
}

TEST(DepthBridge, EndsWhenTheSceneChanges) {
  Scenery scenery;
  ASSERT_TRUE(scenery.step(1, kFrameNs));
  EXPECT_FALSE(scenery.bridge.step(2 * kFrameNs, scenery.renderer.see(looking({-1, -1, 1.2}, 2.5)), scenery.T_begin_last));
}

}  // namespace
}  // namespace camloc
