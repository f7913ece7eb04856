// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Inside of bundle_adjustment.cc: one landmark with its observations is linearized, eliminated from the equations, and found
// again once the cameras have moved. Nothing is kept in between: a landmark's blocks are cheaper to compute twice than to keep.
#pragma once

#include <span>
#include <vector>

#include "core/optimize/block_system.h"
#include "core/optimize/bundle_problem.h"
#include "core/optimize/terms/depth.h"
#include "core/optimize/terms/observation.h"
#include "core/optimize/terms/reprojection.h"

namespace camloc {

/// What is known about one landmark.
struct LandmarkObservations {
  std::span<const BundleObservation> observations;
  std::span<const PointPrior> priors;
};

/// The terms of every observation, each one a file in terms/.
using ObservationTerms = TermList<ReprojectionTerm, DepthTerm>;

/// Not thread-safe: holds scratch for the landmark at hand.
class LandmarkEliminator {
 public:
  LandmarkEliminator(const BundleOptions& options, const std::vector<BundleCamera>& cameras) : options_(options), cameras_(cameras) {}

  /// Adds the landmark at X to the reduced system; returns its cost. With damping > 0 a landmark that its observations leave
  /// free to move along a ray holds no camera.
  double eliminate(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping, BlockSystem* reduced);

  /// The landmark's own step given those of the cameras; zero where nothing sees it.
  [[nodiscard]] Eigen::Vector3d step(const LandmarkObservations& landmark, const Eigen::Vector3d& X, double damping,
                                     const std::vector<Vector6d>& camera_steps) const;

  [[nodiscard]] double cost(const LandmarkObservations& landmark, const Eigen::Vector3d& X) const;

 private:
  struct Entry {
    std::uint32_t row;
    Eigen::Matrix<double, 6, 3> E;  ///< block of camera and landmark, later times L^-T
  };

  void add_camera(ObservationTerms& terms, const SeenLandmark& seen, BlockSystem* reduced);
  Entry* entry_of(std::uint32_t row);

  const BundleOptions& options_;
  const std::vector<BundleCamera>& cameras_;
  std::vector<Entry> entries_;   ///< by row
  std::vector<double*> blocks_;  ///< of one camera with those before it
};

}  // namespace camloc
