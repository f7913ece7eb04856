// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Links between keyframes of a generated room, the truth known.
#include "core/slam/dense_links.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/slam/keyframe_insertion.h"
#include "tests/dense/generated_thumbnail.h"
#include "tests/slam/generated_walk.h"

namespace camloc {
namespace {

using testing::BoxRenderer;
using testing::looking;

struct KeyframesInARoom {
  testing::World world = testing::make_room();
  testing::Viewer viewer{world};
  BoxRenderer renderer{viewer.camera(), {-3, -2.5, 0}, {3, 2.5, 2.8}};
  SlamMap map{viewer.camera(), 1.2F, 8};
  DenseLinks links{viewer.camera()};
  std::vector<Rigid3> T_world_camera;

  /// A keyframe that is `off_m` from where it should be, in its segment.
  int add(const Rigid3& T_true, const Eigen::Vector3d& off_m, std::uint32_t segment, bool has_thumbnail = true) {
    const std::uint64_t frame = T_world_camera.size();
    FrameFeatures view = viewer.see(frame, T_true);
    view.T_map_camera = {T_true.rotation, T_true.translation + off_m};
    T_world_camera.push_back(T_true);
    const std::uint32_t keyframe = insert_keyframe(frame, segment, view, {}, &map);
    return links.add_keyframe(map, keyframe, has_thumbnail ? renderer.see(T_true) : Thumbnail());
  }
};

TEST(DenseLinks, SayHowKeyframesLieWhateverTheMapSays) {
  KeyframesInARoom room;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d off(0.01 * (k % 2), -0.008 * (k % 3), 0.006 * (k % 2));
    EXPECT_EQ(room.add(looking({1.2 + 0.04 * k, 0.9, 1.3}, 0.7 + 0.03 * k, -0.2), off, 0), k == 0 ? 0 : k < 3 ? 1 : 2);
  }
  ASSERT_EQ(room.links.links().size(), 8U);
  for (const PoseGraphEdge& link : room.links.links()) {
    const Rigid3 T_error = link.T_i_j.inverse() * (room.T_world_camera[link.i].inverse() * room.T_world_camera[link.j]);
    EXPECT_LT(T_error.translation.norm(), 0.004);
    EXPECT_LT(log_so3(T_error.rotation).norm(), 0.002);
    EXPECT_LT(std::sqrt(link.covariance.topLeftCorner<3, 3>().trace()), 0.01);
  }
}

TEST(DenseLinks, NoneToAnotherSegmentOrWithoutThumbnail) {
  KeyframesInARoom room;
  const Rigid3 pose = looking({1.2, 0.9, 1.3}, 0.7, -0.2);
  EXPECT_EQ(room.add(pose, {0, 0, 0}, 0), 0);
  EXPECT_EQ(room.add(pose, {0, 0, 0}, 1), 0);
  EXPECT_EQ(room.add(pose, {0, 0, 0}, 1, false), 0);
  EXPECT_EQ(room.add(pose, {0, 0, 0}, 1), 0);  // the one before has none
  EXPECT_EQ(room.add(pose, {0, 0, 0}, 1), 2);
}

TEST(DenseLinks, NoneBetweenViewsThatDoNotOverlap) {
  KeyframesInARoom room;
  EXPECT_EQ(room.add(looking({0, 0, 1.3}, 0.0), {0, 0, 0}, 0), 0);
  EXPECT_EQ(room.add(looking({0, 0, 1.3}, 1.6), {0, 0, 0}, 0), 0);
}

}  // namespace
}  // namespace camloc
