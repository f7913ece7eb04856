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
#include "core/optimize/pose_graph_terms.h"

namespace camloc {
namespace {

constexpr double kFirstDamping = 1e-4, kMinDamping = 1e-7, kMaxDamping = 1e8;
constexpr double kLessDamping = 0.1, kMoreDamping = 10;

bool is_usable(const PointPrior& prior) { return prior.position_m.allFinite() && prior.sigma_m > 0 && std::isfinite(prior.sigma_m); }

bool is_before(const PointPrior& a, const PointPrior& b) { return a.landmark < b.landmark; }

std::vector<PointPrior> sorted_priors(const std::vector<PointPrior>& priors) {
  std::vector<PointPrior> sorted;
  std::copy_if(priors.begin(), priors.end(), std::back_inserter(sorted), is_usable);
  std::stable_sort(sorted.begin(), sorted.end(), is_before);
  return sorted;
}

/// Robust cost and weight of a link by Cauchy's kernel; a link that makes no sense takes no part.
struct RobustLink {
  double cost = 0, weight = 0;
};

RobustLink robust_link(double chi2, double kernel_sigmas) {
  if (!std::isfinite(chi2)) return {};
  const double inner = kernel_sigmas * kernel_sigmas;
  return {inner * std::log1p(chi2 / inner), 1 / (1 + chi2 / inner)};
}

class BundleAdjuster {
 public:
  BundleAdjuster(const BundleOptions& options, BundleProblem* problem);
  BundleReport run(const BundleCallback& on_iteration);

 private:
  struct State {
    std::vector<Rigid3> T_map_camera;
    std::vector<Eigen::Vector3d> landmarks_m;
  };

  /// Calls visit(index, observations) for every landmark that takes part: with two observations or a prior.
  template <class Visit>
  void for_each_landmark(const Visit& visit) const;
  [[nodiscard]] std::vector<BundleCamera> cameras_of(const std::vector<Rigid3>& T_map_camera) const;
  [[nodiscard]] BlockPattern covisibility() const;
  double linearize(const State& state, double damping);
  [[nodiscard]] double cost_of(const State& state) const;
  double add_link(const PoseGraphEdge& link, const State& state);
  bool solve(double damping);
  void step(double damping);
  void place_landmarks_seen_once();

  const BundleOptions& options_;
  BundleModel model_;
  BundleProblem& problem_;
  std::vector<PointPrior> priors_;
  std::vector<std::uint32_t> free_index_;
  std::uint32_t num_landmarks_, num_free_ = 0;
  std::optional<ReducedCameras> reduced_;
  State state_, trial_;
  std::vector<Vector6d> camera_steps_;
};

BundleAdjuster::BundleAdjuster(const BundleOptions& options, BundleProblem* problem)
    : options_(options),
      model_(options),
      problem_(*problem),
      priors_(sorted_priors(problem->priors)),
      num_landmarks_(static_cast<std::uint32_t>(problem->landmarks_m.size())) {
  for (const std::uint8_t is_fixed : problem->is_camera_fixed) free_index_.push_back(is_fixed != 0 ? kFixedCamera : num_free_++);
  if (num_free_ > options.max_dense_cameras)
    reduced_.emplace(covisibility());
  else
    reduced_.emplace(num_free_);
}

template <class Visit>
void BundleAdjuster::for_each_landmark(const Visit& visit) const {
  const BundleObservation* observation = problem_.observations.data();
  const BundleObservation* const observations_end = observation + problem_.observations.size();
  const PointPrior* prior = priors_.data();
  const PointPrior* const priors_end = prior + priors_.size();
  for (std::uint32_t i = 0; i < num_landmarks_; ++i) {
    LandmarkObservations landmark{observation, observation, prior, prior};
    while (landmark.end != observations_end && landmark.end->landmark == i) ++landmark.end;
    while (landmark.priors_end != priors_end && landmark.priors_end->landmark == i) ++landmark.priors_end;
    if (landmark.end - landmark.begin >= 2 || landmark.priors_end != landmark.priors_begin) visit(i, landmark);
    observation = landmark.end;
    prior = landmark.priors_end;
  }
}

std::vector<BundleCamera> BundleAdjuster::cameras_of(const std::vector<Rigid3>& T_map_camera) const {
  std::vector<BundleCamera> cameras;
  cameras.reserve(T_map_camera.size());
  for (std::size_t i = 0; i < T_map_camera.size(); ++i) cameras.emplace_back(T_map_camera[i], free_index_[i]);
  return cameras;
}

BlockPattern BundleAdjuster::covisibility() const {
  BlockPattern pattern(num_free_);
  for_each_landmark([&](std::uint32_t, const LandmarkObservations& landmark) {
    for (const BundleObservation* a = landmark.begin; a != landmark.end; ++a) {
      if (free_index_[a->camera] == kFixedCamera) continue;
      for (const BundleObservation* b = landmark.begin; b != a; ++b) {
        if (free_index_[b->camera] != kFixedCamera) pattern.add(free_index_[a->camera], free_index_[b->camera]);
      }
    }
  });
  for (const PoseGraphEdge& link : problem_.links) {
    const std::uint32_t i = free_index_[link.i], j = free_index_[link.j];
    if (i != kFixedCamera && j != kFixedCamera) pattern.add(i, j);
  }
  return pattern;
}

double BundleAdjuster::linearize(const State& state, double damping) {
  const std::vector<BundleCamera> cameras = cameras_of(state.T_map_camera);
  LandmarkEliminator eliminator(model_, cameras);
  reduced_->system.set_zero();
  reduced_->diagonal.assign(num_free_, Vector6d::Zero());
  double cost = 0;
  for_each_landmark([&](std::uint32_t i, const LandmarkObservations& landmark) {
    cost += eliminator.eliminate(landmark, state.landmarks_m[i], damping, &*reduced_);
  });
  for (const PoseGraphEdge& link : problem_.links) cost += add_link(link, state);
  return cost;
}

double BundleAdjuster::cost_of(const State& state) const {
  const std::vector<BundleCamera> cameras = cameras_of(state.T_map_camera);
  const LandmarkEliminator eliminator(model_, cameras);
  double cost = 0;
  for_each_landmark(
      [&](std::uint32_t i, const LandmarkObservations& landmark) { cost += eliminator.cost(landmark, state.landmarks_m[i]); });
  for (const PoseGraphEdge& link : problem_.links) {
    const EdgeTerm term = edge_term(link, state.T_map_camera[link.i], state.T_map_camera[link.j]);
    cost += robust_link(term.residual.squaredNorm(), options_.link_kernel_sigmas).cost;
  }
  return cost;
}

/// Adds the link to the system over the cameras; returns its cost.
double BundleAdjuster::add_link(const PoseGraphEdge& link, const State& state) {
  const std::uint32_t i = free_index_[link.i], j = free_index_[link.j];
  const EdgeTerm term = edge_term(link, state.T_map_camera[link.i], state.T_map_camera[link.j]);
  const RobustLink robust = robust_link(term.residual.squaredNorm(), options_.link_kernel_sigmas);
  if (robust.weight == 0.0 || link.i == link.j) return robust.cost;
  const auto add_own = [&](std::uint32_t row, const Matrix6d& J) {
    if (row == kFixedCamera) return;
    const Matrix6d H = robust.weight * J.transpose() * J;
    Eigen::Map<Matrix6d>(reduced_->system.block(row, row)) += H;
    reduced_->diagonal[row] += H.diagonal();
    reduced_->system.gradient(row) += robust.weight * J.transpose() * term.residual;
  };
  add_own(i, term.J_i);
  add_own(j, term.J_j);
  if (i == kFixedCamera || j == kFixedCamera) return robust.cost;
  const Matrix6d& J_row = i < j ? term.J_i : term.J_j;
  const Matrix6d& J_column = i < j ? term.J_j : term.J_i;
  Eigen::Map<Matrix6d>(reduced_->system.block(std::min(i, j), std::max(i, j))) += robust.weight * J_row.transpose() * J_column;
  return robust.cost;
}

/// The cameras' steps from the system as it was linearized; a camera that sees nothing keeps its place.
bool BundleAdjuster::solve(double damping) {
  for (std::uint32_t i = 0; i < num_free_; ++i) {
    Eigen::Map<Matrix6d> block(reduced_->system.block(i, i));
    for (int k = 0; k < 6; ++k) {
      const double diagonal = reduced_->diagonal[i][k];
      block(k, k) += diagonal > 0 ? damping * diagonal : 1.0;
    }
  }
  return reduced_->system.solve(&camera_steps_);
}

/// Moves the trial to where the cameras' steps lead; the landmarks follow.
void BundleAdjuster::step(double damping) {
  trial_ = state_;
  for (std::size_t i = 0; i < free_index_.size(); ++i) {
    if (free_index_[i] == kFixedCamera) continue;
    trial_.T_map_camera[i] = moved_in_camera_axes(state_.T_map_camera[i], camera_steps_[free_index_[i]]);
  }
  const std::vector<BundleCamera> cameras = cameras_of(state_.T_map_camera);
  const LandmarkEliminator eliminator(model_, cameras);
  for_each_landmark([&](std::uint32_t i, const LandmarkObservations& landmark) {
    trial_.landmarks_m[i] += eliminator.step(landmark, state_.landmarks_m[i], damping, camera_steps_);
  });
}

/// A landmark with one observation does not move a camera; with depth it is where that observation says.
void BundleAdjuster::place_landmarks_seen_once() {
  const auto& observations = problem_.observations;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const BundleObservation& o = observations[i];
    const bool is_alone = (i == 0 || observations[i - 1].landmark != o.landmark) &&
                          (i + 1 == observations.size() || observations[i + 1].landmark != o.landmark);
    if (!is_alone || !has_depth(model_, o) || !std::isfinite(o.x) || !std::isfinite(o.y)) continue;
    const bool has_prior = std::binary_search(priors_.begin(), priors_.end(), PointPrior{o.landmark, {}, 0}, is_before);
    if (has_prior || !problem_.T_map_camera[o.camera].translation.allFinite()) continue;
    problem_.landmarks_m[o.landmark] = problem_.T_map_camera[o.camera] * (o.depth_m * Eigen::Vector3d(o.x, o.y, 1));
  }
}

BundleReport BundleAdjuster::run(const BundleCallback& on_iteration) {
  BundleReport report;
  report.num_free_cameras = num_free_;
  report.is_sparse = reduced_->system.is_sparse();
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

}  // namespace

BundleReport adjust_bundle(const BundleOptions& options, BundleProblem* problem, const BundleCallback& on_iteration) {
  assert(problem->is_camera_fixed.size() == problem->T_map_camera.size());
  assert(std::is_sorted(problem->observations.begin(), problem->observations.end(),
                        [](const BundleObservation& a, const BundleObservation& b) { return a.landmark < b.landmark; }));
  return BundleAdjuster(options, problem).run(on_iteration);
}

std::vector<BundleResidual> bundle_residuals(const BundleOptions& options, const BundleProblem& problem) {
  constexpr float kBehindCamera_sigmas = 1e9F;
  const BundleModel model(options);
  std::vector<BundleCamera> cameras;
  for (const Rigid3& T_map_camera : problem.T_map_camera) cameras.emplace_back(T_map_camera, kFixedCamera);
  std::vector<BundleResidual> residuals;
  residuals.reserve(problem.observations.size());
  for (const BundleObservation& o : problem.observations) {
    const BundleTerms t = bundle_terms(model, o, cameras[o.camera], problem.landmarks_m[o.landmark].data());
    const double length = std::sqrt(t.du * t.du + t.dv * t.dv) * pixels_to_sigmas(model, o);
    BundleResidual& residual = residuals.emplace_back();
    residual.pixel_sigmas = t.p[2] > kMinBundleDepth_m && length < kBehindCamera_sigmas ? static_cast<float>(length) : kBehindCamera_sigmas;
    if (has_depth(model, o) && std::isfinite(t.p[2])) {
      residual.depth_sigmas = static_cast<float>((o.depth_m - t.p[2]) / depth_sigma_m(model, o.depth_m));
    }
  }
  return residuals;
}

}  // namespace camloc
