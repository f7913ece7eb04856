// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/merge/map_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/order_statistics.h"
#include "core/geometry/alignment.h"
#include "core/optimize/pose_graph.h"
#include "core/slam/dead_reckoning.h"

namespace camloc {
namespace {

constexpr std::uint32_t kMinShared = 10;
constexpr std::size_t kMaxLinks = 8;             // of a keyframe to others, the strongest
constexpr double kFixM = 0.01, kFixRad = 0.004;  // what the covariance of a fix leaves out: landmarks have common errors
constexpr double kKernelSigmas = 3;
constexpr double kAxisM = 2;  // points this far along a keyframe's axes stand for its rotation

PoseGraphEdge link(const std::vector<Rigid3>& T_map_pose, std::uint32_t i, std::uint32_t j, std::uint32_t num_shared) {
  const Rigid3 T_i_j = T_map_pose[i].inverse() * T_map_pose[j];
  return {i, j, T_i_j, link_covariance(T_i_j, num_shared)};
}

/// Which keyframes hang together (union-find).
class Components {
 public:
  explicit Components(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) { parent_[std::max(root(i), root(j))] = std::min(root(i), root(j)); }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The fewer landmarks two keyframes share, the worse they know their relative pose.
void add_links(const MapData& b, PoseGraph* graph, Components* components) {
  auto covisible = find_covisible_keyframes(b, kMinShared);
  for (auto& others : covisible) others.resize(std::min(kMaxLinks, others.size()));
  for (std::uint32_t k = 0; k < covisible.size(); ++k) {
    for (const CovisibleKeyframe& other : covisible[k]) {
      const auto& back = covisible[other.keyframe];
      const bool is_mutual = std::any_of(back.begin(), back.end(), [&](const CovisibleKeyframe& s) { return s.keyframe == k; });
      if (is_mutual && other.keyframe < k) continue;  // was added from the other side
      graph->edges.push_back(link(graph->T_map_pose, k, other.keyframe, other.num_shared));
      components->join(k, other.keyframe);
    }
  }
}

/// A part without any fix goes with the nearest keyframe of one that has: the map knows where they were to each other.
void tie_loose_parts(std::span<const KeyframeFix> fixes, PoseGraph* graph, Components* components) {
  const auto size = static_cast<std::uint32_t>(graph->T_map_pose.size());
  std::vector<std::uint8_t> is_held(size, 0);
  for (const KeyframeFix& fix : fixes) is_held[components->root(fix.keyframe)] = 1;
  for (std::uint32_t part = 0; part < size; ++part) {
    if (components->root(part) != part || is_held[part] != 0) continue;
    std::uint32_t from = part, to = fixes.front().keyframe;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = part; i < size; ++i) {
      if (components->root(i) != part) continue;
      for (std::uint32_t j = 0; j < size; ++j) {
        if (is_held[components->root(j)] == 0) continue;
        const double distance = (graph->T_map_pose[i].translation - graph->T_map_pose[j].translation).norm();
        if (distance >= least) continue;
        least = distance;
        from = i;
        to = j;
      }
    }
    graph->edges.push_back(link(graph->T_map_pose, from, to, 0));
  }
}

/// Landmarks follow the mean of the keyframes that see them.
void move_landmarks(const std::vector<Rigid3>& T_a_keyframe, MapData* b) {
  std::vector<Eigen::Vector3d> sum(b->landmarks.size(), Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> direction(b->landmarks.size(), Eigen::Vector3d::Zero());
  std::vector<double> count(b->landmarks.size(), 0);
  for (std::size_t k = 0; k < T_a_keyframe.size(); ++k) {
    const Rigid3 T_a_b = T_a_keyframe[k] * b->keyframes[k].T_map_camera.inverse();
    for (const std::uint32_t i : b->keyframes[k].landmarks) {
      sum[i] += T_a_b * b->landmarks[i].position_m.cast<double>();
      direction[i] += T_a_b.rotation * b->landmarks[i].direction.cast<double>();
      count[i] += 1;
    }
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (count[i] == 0) continue;
    b->landmarks[i].position_m = (sum[i] / count[i]).cast<float>();
    b->landmarks[i].direction = direction[i].normalized().cast<float>();
  }
}

/// The rigid motion of keyframes, each as its centre and points along its axes.
void fit_rigid_part(const MapData& b, const std::vector<Rigid3>& T_a_keyframe, double sigma_m, MapAlignmentReport* report) {
  std::vector<PointPair> pairs;
  for (std::size_t k = 0; k < T_a_keyframe.size(); ++k) {
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, kAxisM), Eigen::Vector3d(kAxisM, 0, 0)})
      pairs.push_back({T_a_keyframe[k] * p, b.keyframes[k].T_map_camera * p, sigma_m});
  }
  const Alignment alignment = align_rigid(pairs);
  report->T_a_b = alignment.T_a_b;
  // Neighbouring keyframes err together: as if every tenth had been measured.
  const double spread = std::max(1.0, alignment.rms_m * alignment.rms_m / (3 * sigma_m * sigma_m));
  report->covariance = alignment.covariance * (10 * spread);
  for (std::size_t k = 0; k < T_a_keyframe.size(); ++k) {
    const Eigen::Vector3d rigid = alignment.T_a_b * b.keyframes[k].T_map_camera.translation;
    report->deformation_m = std::max(report->deformation_m, (T_a_keyframe[k].translation - rigid).norm());
  }
}

}  // namespace

MapAlignmentReport align_map(std::span<const KeyframeFix> fixes, MapData* b) {
  PoseGraph graph;
  for (const MapKeyframe& keyframe : b->keyframes) graph.T_map_pose.push_back(keyframe.T_map_camera);
  graph.is_fixed.assign(graph.T_map_pose.size(), 0);
  Components components(graph.T_map_pose.size());
  add_links(*b, &graph, &components);
  tie_loose_parts(fixes, &graph, &components);
  for (const KeyframeFix& fix : fixes)
    graph.priors.push_back({fix.keyframe, fix.T_a_camera, fix.covariance + diagonal_covariance(kFixM, kFixRad)});
  // The graph starts where the most certain fix puts all of them.
  const auto best = std::max_element(fixes.begin(), fixes.end(),
                                     [](const KeyframeFix& i, const KeyframeFix& j) { return i.num_inliers < j.num_inliers; });
  const Rigid3 T_a_b = best->T_a_camera * b->keyframes[best->keyframe].T_map_camera.inverse();
  for (Rigid3& T : graph.T_map_pose) T = T_a_b * T;
  optimize_pose_graph(&graph);  // all of it first: a kernel would hold far fixes for wrong before the map has bent
  optimize_pose_graph(&graph, kKernelSigmas);

  MapAlignmentReport report;
  std::vector<double> residuals_m, residuals_rad;
  for (const KeyframeFix& fix : fixes) {
    const Rigid3& T = graph.T_map_pose[fix.keyframe];
    residuals_m.push_back((T.translation - fix.T_a_camera.translation).norm());
    residuals_rad.push_back(rotation_distance_rad(T.rotation, fix.T_a_camera.rotation));
  }
  report.residual_m = upper_median(residuals_m);
  report.residual_rad = upper_median(residuals_rad);
  fit_rigid_part(*b, graph.T_map_pose, std::max(report.residual_m, 0.001), &report);
  move_landmarks(graph.T_map_pose, b);
  for (std::size_t k = 0; k < graph.T_map_pose.size(); ++k) b->keyframes[k].T_map_camera = graph.T_map_pose[k];
  return report;
}

}  // namespace camloc
