// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The loop of Levenberg-Marquardt over cameras and landmarks. Each state is linearized when its cost is computed, with the
// damping it will be left with if it is accepted, so that an accepted step costs one pass over the observations.
#include "core/optimize/bundle_adjustment.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/pose_jacobian.h"
#include "core/optimize/landmark_elimination.h"

namespace camloc {
namespace {

constexpr double kFirstDamping = 1e-4, kMinDamping = 1e-7, kMaxDamping = 1e8;
constexpr double kLessDamping = 0.1, kMoreDamping = 10;

constexpr double kLinkKernelSigmas = 3.5;  // over the Mahalanobis distance of a link, which has six dimensions

bool is_before(const PointPrior& a, const PointPrior& b) { return a.landmark < b.landmark; }

std::vector<PointPrior> sorted_priors(const std::vector<PointPrior>& priors) {
  std::vector<PointPrior> sorted;
  std::copy_if(priors.begin(), priors.end(), std::back_inserter(sorted), [](const PointPrior& prior) { return prior.is_usable(); });
  std::stable_sort(sorted.begin(), sorted.end(), is_before);
  return sorted;
}

class BundleAdjuster {
 public:
  BundleAdjuster(const BundleOptions& options, BundleProblem* problem)
      : options_(options),
        problem_(*problem),
        priors_(sorted_priors(problem->priors)),
        links_(problem->links, kLinkKernelSigmas),
        pose_terms_{&links_},
        rows_(rows_of_poses(problem->is_camera_fixed)),
        num_landmarks_(static_cast<std::uint32_t>(problem->landmarks_m.size())),
        num_free_(num_free_poses(rows_)) {
    pose_terms_.insert(pose_terms_.end(), problem->pose_terms.begin(), problem->pose_terms.end());
    if (num_free_ > options.max_dense_cameras)
      equations_.emplace(covisibility());
    else
      equations_.emplace(num_free_);
  }

  BundleReport run(const BundleCallback& on_iteration) {
    BundleReport report;
    report.is_sparse = equations_->is_sparse();
    state_ = {std::move(problem_.T_map_camera), std::move(problem_.landmarks_m)};
    double damping = kFirstDamping;
    double cost = linearize(state_, damping);
    report.initial_cost = cost;
    report.is_converged = cost == 0.0;
    while (!report.is_converged && !report.is_stopped && report.num_iterations < options_.max_iterations) {
      const bool is_last = ++report.num_iterations == options_.max_iterations;
      const double less_damping = std::max(damping * kLessDamping, kMinDamping);
      double trial_cost = std::numeric_limits<double>::infinity();
      if (solve(damping)) {
        step(damping);
        trial_cost = is_last ? cost_of(trial_) : linearize(trial_, less_damping);
      }
      if (trial_cost <= cost) {
        report.is_converged = cost - trial_cost <= options_.min_relative_decrease * cost;
        std::swap(state_, trial_);
        cost = trial_cost;
        damping = less_damping;
      } else {
        damping *= kMoreDamping;
        report.is_converged = damping > kMaxDamping;  // no step however small lowers the cost
        if (!is_last && !report.is_converged) linearize(state_, damping);
      }
      report.is_stopped = on_iteration && !on_iteration(report.num_iterations, cost);
    }
    report.final_cost = cost;
    problem_.T_map_camera = std::move(state_.T_map_camera);
    problem_.landmarks_m = std::move(state_.landmarks_m);
    place_landmarks_seen_once();
    return report;
  }

 private:
  struct State {
    std::vector<Rigid3> T_map_camera;
    std::vector<Eigen::Vector3d> landmarks_m;
  };

  /// Calls visit(index, observations) for every landmark that takes part: with two observations or a prior.
  template <class Visit>
  void for_each_landmark(const Visit& visit) const {
    const std::span<const BundleObservation> observations = problem_.observations;
    const std::span<const PointPrior> priors = priors_;
    std::size_t o = 0, p = 0;
    for (std::uint32_t i = 0; i < num_landmarks_; ++i) {
      const std::size_t first_o = o, first_p = p;
      while (o < observations.size() && observations[o].landmark == i) ++o;
      while (p < priors.size() && priors[p].landmark == i) ++p;
      const LandmarkObservations landmark{observations.subspan(first_o, o - first_o), priors.subspan(first_p, p - first_p)};
      if (landmark.observations.size() >= 2 || !landmark.priors.empty()) visit(i, landmark);
    }
  }

  std::vector<BundleCamera> cameras_of(const std::vector<Rigid3>& T_map_camera) const {
    std::vector<BundleCamera> cameras;
    cameras.reserve(T_map_camera.size());
    for (std::size_t i = 0; i < T_map_camera.size(); ++i) cameras.emplace_back(T_map_camera[i], rows_[i]);
    return cameras;
  }

  BlockPattern covisibility() const {
    BlockPattern pattern(num_free_);
    for_each_landmark([&](std::uint32_t, const LandmarkObservations& landmark) {
      for (const BundleObservation& a : landmark.observations) {
        if (rows_[a.camera] == kFixedPose) continue;
        for (const BundleObservation& b : landmark.observations) {
          if (&b == &a) break;
          if (rows_[b.camera] != kFixedPose) pattern.add(rows_[a.camera], rows_[b.camera]);
        }
      }
    });
    for (const PoseTerms* terms : pose_terms_) terms->mark(rows_, &pattern);
    return pattern;
  }

  double linearize(const State& state, double damping) {
    const std::vector<BundleCamera> cameras = cameras_of(state.T_map_camera);
    LandmarkEliminator eliminator(options_, cameras);
    equations_->set_zero();
    double cost = 0;
    for_each_landmark([&](std::uint32_t i, const LandmarkObservations& landmark) {
      cost += eliminator.eliminate(landmark, state.landmarks_m[i], damping, &*equations_);
    });
    for (const PoseTerms* terms : pose_terms_) cost = terms->add(state.T_map_camera, rows_, cost, &*equations_);
    return cost;
  }

  double cost_of(const State& state) const {
    const std::vector<BundleCamera> cameras = cameras_of(state.T_map_camera);
    const LandmarkEliminator eliminator(options_, cameras);
    double cost = 0;
    for_each_landmark(
        [&](std::uint32_t i, const LandmarkObservations& landmark) { cost += eliminator.cost(landmark, state.landmarks_m[i]); });
    for (const PoseTerms* terms : pose_terms_) cost = terms->add_cost(state.T_map_camera, cost);
    return cost;
  }

  /// The cameras' steps from the system as it was linearized; a camera that sees nothing keeps its place.
  bool solve(double damping) {
    for (std::uint32_t i = 0; i < num_free_; ++i) {
      Eigen::Map<Matrix6d> block(equations_->block(i, i));
      for (int k = 0; k < 6; ++k) {
        const double diagonal = equations_->diagonal(i)[k];
        block(k, k) += diagonal > 0 ? damping * diagonal : 1.0;
      }
    }
    return equations_->solve(&camera_steps_);
  }

  /// Moves the trial to where the cameras' steps lead; the landmarks follow.
  void step(double damping) {
    trial_ = state_;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] == kFixedPose) continue;
      trial_.T_map_camera[i] = moved_in_camera_axes(state_.T_map_camera[i], camera_steps_[rows_[i]]);
    }
    const std::vector<BundleCamera> cameras = cameras_of(state_.T_map_camera);
    const LandmarkEliminator eliminator(options_, cameras);
    for_each_landmark([&](std::uint32_t i, const LandmarkObservations& landmark) {
      trial_.landmarks_m[i] += eliminator.step(landmark, state_.landmarks_m[i], damping, camera_steps_);
    });
  }

  /// A landmark with one observation does not move a camera; with depth it is where that observation says.
  void place_landmarks_seen_once() {
    const auto& observations = problem_.observations;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const BundleObservation& o = observations[i];
      const bool is_alone = (i == 0 || observations[i - 1].landmark != o.landmark) &&
                            (i + 1 == observations.size() || observations[i + 1].landmark != o.landmark);
      if (!is_alone || !DepthTerm::is_measured(options_, o) || !std::isfinite(o.x) || !std::isfinite(o.y)) continue;
      const bool has_prior = std::binary_search(priors_.begin(), priors_.end(), PointPrior{o.landmark, {}, 0}, is_before);
      if (has_prior || !problem_.T_map_camera[o.camera].translation.allFinite()) continue;
      problem_.landmarks_m[o.landmark] = problem_.T_map_camera[o.camera] * (o.depth_m * Eigen::Vector3d(o.x, o.y, 1));
    }
  }

  const BundleOptions& options_;
  BundleProblem& problem_;
  std::vector<PointPrior> priors_;
  PoseTermsOf<PoseGraphEdge> links_;
  std::vector<const PoseTerms*> pose_terms_;  ///< links, and what else the problem brings
  std::vector<std::uint32_t> rows_;           ///< of the cameras
  std::uint32_t num_landmarks_, num_free_;
  std::optional<BlockSystem> equations_;
  State state_, trial_;
  std::vector<Vector6d> camera_steps_;
};

}  // namespace

BundleReport adjust_bundle(const BundleOptions& options, BundleProblem* problem, const BundleCallback& on_iteration) {
  assert(problem->is_camera_fixed.size() == problem->T_map_camera.size());
  assert(std::is_sorted(problem->observations.begin(), problem->observations.end(),
                        [](const BundleObservation& a, const BundleObservation& b) { return a.landmark < b.landmark; }));
  return BundleAdjuster(options, problem).run(on_iteration);
}

std::vector<BundleResidual> bundle_residuals(const BundleOptions& options, const BundleProblem& problem) {
  constexpr float kBehindCamera_sigmas = 1e9F;
  std::vector<BundleCamera> cameras;
  for (const Rigid3& T_map_camera : problem.T_map_camera) cameras.emplace_back(T_map_camera, kFixedPose);
  std::vector<BundleResidual> residuals;
  residuals.reserve(problem.observations.size());
  for (const BundleObservation& o : problem.observations) {
    const SeenLandmark seen(o, cameras[o.camera], problem.landmarks_m[o.landmark].data());
    const double length = std::sqrt(seen.off) * ReprojectionTerm::pixels_to_sigmas(options, o);
    BundleResidual& residual = residuals.emplace_back();
    residual.pixel_sigmas =
        seen.p[2] > SeenLandmark::kMinDepth_m && length < kBehindCamera_sigmas ? static_cast<float>(length) : kBehindCamera_sigmas;
    if (DepthTerm::is_measured(options, o) && std::isfinite(seen.p[2])) {
      residual.depth_sigmas = static_cast<float>((o.depth_m - seen.p[2]) / options.depth_noise.sigma_m(o.depth_m));
    }
  }
  return residuals;
}

}  // namespace camloc
