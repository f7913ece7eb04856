// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From features with depth in posed views to landmarks: a feature close to a projected landmark, at its depth and alike in
// appearance, is another observation of it; any other feature with depth starts a landmark. Recorded poses disagree with
// each other between distant views (7-Scenes kitchen: 4 cm), so two sightings farther apart than the depth noise explains
// stay two landmarks: each of them agrees with the views around it, a mean of both would agree with none.
// Offline; allocates as it goes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/features/descriptor.h"
#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/map/map_data.h"
#include "core/registration/view_features.h"

namespace camloc {

struct FusionOptions {
  double radius_px = 4.0;         ///< of level 0; grows with the feature's level
  int max_distance = 64;          ///< descriptor distance to any appearance of the landmark
  int appearance_distance = 48;   ///< farther than this from all appearances is a new one
  int max_descriptors = 4;        ///< appearances a landmark may keep
  double max_depth_sigmas = 3.0;  ///< tolerance along the optical axis
  double min_depth_tolerance_m = 0.02;
  double max_depth_tolerance_m = 0.30;
  double max_reference_ratio = 2.0;  ///< of the reference distance to the range the landmark has been seen with
  float scale_factor = 1.2F;
  int num_levels = 8;
  int max_features = 2000;  ///< features of a view beyond this are ignored
};

/// A landmark as one view saw it.
struct ViewObservation {
  std::uint32_t landmark = 0;
  std::uint8_t cell = 0;  ///< of kCellColumns x kCellRows over the image, row by row
};
inline constexpr int kCellColumns = 4, kCellRows = 3, kNumCells = kCellColumns * kCellRows;

struct FusionCounts {
  std::uint32_t fused = 0;     ///< features that became another observation
  std::uint32_t created = 0;   ///< features that started a landmark
  std::uint32_t absorbed = 0;  ///< features that repeat a landmark this view already saw (the same corner on another level)
};

/// Not thread-safe. The same views in the same order give the same bits.
class LandmarkFusion {
 public:
  LandmarkFusion(const Intrinsics& color, const DepthNoise& depth_noise, const FusionOptions& options);

  FusionCounts add_view(const ViewFeatures& view);

  [[nodiscard]] std::size_t num_landmarks() const { return landmarks_.size(); }
  [[nodiscard]] std::uint64_t num_observations() const { return num_observations_; }
  /// What each view saw, in the order of add_view.
  [[nodiscard]] const std::vector<std::vector<ViewObservation>>& views() const { return views_; }
  [[nodiscard]] const std::vector<Rigid3>& poses() const { return poses_; }

  /// All landmarks, with descriptors ordered by how many observations they stand for: the first is the medoid.
  /// `support[i][k]` is the number of sampled observations that descriptor k of landmark i stands for.
  [[nodiscard]] std::vector<MapLandmark> landmarks(std::vector<std::vector<std::uint32_t>>* support) const;

 private:
  static constexpr std::size_t kMaxSamples = 12;  ///< observations of a landmark whose descriptors are remembered
  struct Sample {
    Descriptor descriptor;
    float angle_rad = 0;
  };
  struct Fused {
    Eigen::Vector3d position_m;                             ///< current estimate
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< sum of the observations' inverse covariances
    Eigen::Vector3d information_vector = Eigen::Vector3d::Zero();
    Eigen::Vector3d origin_m;  ///< first point: sums below are relative to it
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_squared = 0;
    float min_reference_m = 0, max_reference_m = 0;
    std::uint32_t num_observations = 0;
    std::vector<Descriptor> appearances;  ///< what new features are compared with
    std::vector<Sample> samples;          ///< an even sample of the observations, for the final choice
  };
  struct Pair {
    int distance;
    std::uint32_t landmark;
    std::int32_t feature;
  };

  void gather_candidates(const ViewFeatures& view);
  void find_pairs(const ViewFeatures& view);
  void pair_landmark(const ViewFeatures& view, std::uint32_t index, const Eigen::Vector3d& p_camera);
  bool is_consistent(const Fused& landmark, double z_m, const ViewFeatures& view, std::size_t feature) const;
  std::int64_t find_new_landmark(const ViewFeatures& view, std::size_t feature) const;
  void observe(const ViewFeatures& view, std::size_t feature, std::uint32_t index);
  void widen_scale(const ViewFeatures& view, std::size_t feature, Fused* landmark) const;
  std::uint32_t create(const ViewFeatures& view, std::size_t feature);
  void add_appearance(const Keypoint& keypoint, const Descriptor& descriptor, std::uint32_t index);
  void choose_descriptors(const Fused& from, MapLandmark* to, std::vector<std::uint32_t>* support) const;
  void set_viewing_directions(std::vector<MapLandmark>* landmarks) const;
  [[nodiscard]] std::uint8_t cell_of(const Keypoint& keypoint) const;
  [[nodiscard]] float reference_m(const ViewFeatures& view, std::size_t feature) const;

  Intrinsics color_;
  DepthNoise depth_noise_;
  FusionOptions options_;
  std::vector<float> scale_;  ///< per level
  FeatureGrid grid_;
  std::vector<Fused> landmarks_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> voxels_;  ///< looked up only, never iterated
  std::vector<std::vector<ViewObservation>> views_;
  std::vector<Rigid3> poses_;
  std::uint64_t num_observations_ = 0;

  // Working buffers of add_view.
  std::vector<std::uint32_t> candidates_;
  std::vector<Pair> pairs_;
  std::vector<std::int64_t> landmark_of_feature_;
  std::vector<std::uint8_t> is_new_;
};

}  // namespace camloc
