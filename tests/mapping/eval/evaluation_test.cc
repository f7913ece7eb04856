// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps and clouds whose relation is known: what is measured, what ICP moved, and whether another place would do as well.
#include "tools/mapping/eval/evaluation.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/base/recording_observer.h"
#include "tests/mapping/flat_map.h"

namespace camloc::mapping {
namespace {

class EvaluationTest : public ::testing::Test {
 protected:
  const MapView* open(const MapData& data) {
    EXPECT_TRUE(write_map(data, folder_.file("m.cmap")).is_ok());
    map_.emplace(std::move(MapView::open(folder_.file("m.cmap"))).value());
    return &*map_;
  }
  static PointCloud cloud_of(const std::vector<Eigen::Vector3f>& points_m) {
    PointCloud cloud;
    cloud.points_m = points_m;
    cloud.num_read = points_m.size();
    return cloud;
  }
  testing::TemporaryFolder folder_;
  std::optional<MapView> map_;
};

/// The walls, floor and ceiling of an empty room of 6 x 4 x 2.6 m: turned by half a turn it is the same.
struct EmptyRoom {
  EmptyRoom() {
    Random random(5);
    const Eigen::Vector3d size(6, 4, 2.6);
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const double side : {-0.5, 0.5}) {
        for (double a = -0.5; a <= 0.5; a += 0.04 / size[u]) {
          for (double b = -0.5; b <= 0.5; b += 0.04 / size[v]) {
            Eigen::Vector3d p;
            p[axis] = side * size[axis], p[u] = a * size[u], p[v] = b * size[v];
            cloud_m.push_back(p.cast<float>());
            if (random.below(30) == 0) landmarks_m.push_back(p);
          }
        }
      }
    }
  }
  std::vector<Eigen::Vector3f> cloud_m;
  std::vector<Eigen::Vector3d> landmarks_m;
};

bool says_two_places(const Evaluation& evaluation) {
  for (const std::string& warning : warnings_of(evaluation))
    if (warning.rfind("START", 0) == 0) return true;
  return false;
}

const Rigid3& far_frame() {
  static const Rigid3 T{exp_so3({0, 0, 0.4}), {30, -20, 3}};
  return T;
}

TEST_F(EvaluationTest, AnEmptyRoomFitsInTwoPlaces) {
  const EmptyRoom room;
  const PointCloud cloud = cloud_of(room.cloud_m);
  EvaluationInput input{open(map_of(room.landmarks_m, far_frame())), &cloud, {}, {}};
  const auto evaluation = evaluate_map(input, {.start = AlignStart::kSearch});
  ASSERT_TRUE(evaluation.is_ok()) << evaluation.status().message();
  ASSERT_TRUE(evaluation->search);
  EXPECT_FALSE(evaluation->search->is_identity);
  EXPECT_LT(evaluation->search->rival_score_m, 1.25 * evaluation->search->score_m);
  EXPECT_TRUE(says_two_places(*evaluation));
}

TEST_F(EvaluationTest, AFurnishedFlatFitsInOne) {
  const PointCloud cloud = cloud_of(flat().cloud_m);
  EvaluationInput input{open(map_of_flat(far_frame())), &cloud, {}, {}};
  const auto evaluation = evaluate_map(input, {.start = AlignStart::kSearch});
  ASSERT_TRUE(evaluation.is_ok()) << evaluation.status().message();
  ASSERT_TRUE(evaluation->search);
  EXPECT_GT(evaluation->search->rival_score_m, 2 * evaluation->search->score_m);
  EXPECT_FALSE(says_two_places(*evaluation));
  EXPECT_LT((evaluation->T_cloud_map * far_frame()).translation.norm(), 0.01);
}

// The points were surveyed 5 cm beside the scan: aligned by them nothing is left over, and ICP moves the map away from them.
TEST_F(EvaluationTest, ResidualsBeforeAndAfterIcp) {
  const PointCloud cloud = cloud_of(flat().cloud_m);
  EvaluationInput input{open(map_of_flat({})), &cloud, {}, {}};
  const Eigen::Vector3d beside(0.03, 0.04, 0);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), {8, 0, 0}, {8, 5, 0}, {0, 5, 2.6}})
    input.points.push_back({"P" + std::to_string(input.points.size()), p, p + beside, 0.01});
  const auto evaluation = evaluate_map(input, {});
  ASSERT_TRUE(evaluation.is_ok()) << evaluation.status().message();
  EXPECT_EQ(evaluation->start, AlignStart::kPoints);
  ASSERT_EQ(evaluation->residuals.size(), 4U);
  for (const PointResidual& r : evaluation->residuals) {
    EXPECT_LT(r.aligned_m.norm(), 1e-9) << r.name;
    EXPECT_NEAR(r.final_m.norm(), 0.05, 0.005) << r.name;
    EXPECT_LT((r.final_m + beside).norm(), 0.01) << "map minus cloud";
  }
  EXPECT_NEAR(evaluation->moved_m, 0.05, 0.005);
  EXPECT_LT(evaluation->T_cloud_map.translation.norm(), 0.005);
  EXPECT_LT((evaluation->T_cloud_map_start.translation - beside).norm(), 1e-9);
  const auto without = evaluate_map(input, {.has_icp = false});
  ASSERT_TRUE(without.is_ok());
  EXPECT_FALSE(without->registration);
  for (const PointResidual& r : without->residuals) EXPECT_LT(r.final_m.norm(), 1e-9) << r.name;
}

TEST_F(EvaluationTest, AnObserverSeesTheStagesAndEndsIt) {
  const PointCloud cloud = cloud_of(flat().cloud_m);
  EvaluationInput input{open(map_of_flat({})), &cloud, {}, {}};
  testing::RecordingObserver all;
  ASSERT_TRUE(evaluate_map(input, {.start = AlignStart::kNone}, all).is_ok());
  ASSERT_EQ(all.steps.size(), 5U);
  EXPECT_EQ(all.steps.front().what, "indexing the cloud ...");
  EXPECT_EQ(all.steps.back().what, "measuring distances ...");
  for (std::size_t stage = 1; stage <= 5; ++stage) {
    testing::RecordingObserver some(stage);
    EXPECT_EQ(evaluate_map(input, {.start = AlignStart::kNone}, some).status().code(), ErrorCode::kIo) << stage;
    EXPECT_EQ(some.steps.size(), stage);
  }
}

}  // namespace
}  // namespace camloc::mapping
