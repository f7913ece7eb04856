// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From features with depth in posed views to landmarks: a feature close to a projected landmark, at its depth and alike in
// appearance, is another observation of it; any other feature with depth starts a landmark. Recorded poses disagree with
// each other between distant views (7-Scenes kitchen: 4 cm), so two observations farther apart than the depth noise explains
// stay two landmarks: each of them agrees with the views around it, a mean of both would agree with none.
// Offline; allocates as it goes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/features/descriptor.h"
#include "core/features/matcher.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/map/map_data.h"
#include "core/registration/frame_features.h"

namespace camloc {

/// A landmark as one view saw it.
struct ViewObservation {
  std::uint32_t landmark = 0;
  std::uint8_t cell = 0;  ///< of kCellColumns x kCellRows over the image, row by row
};
inline constexpr int kCellColumns = 4, kCellRows = 3, kNumCells = kCellColumns * kCellRows;

/// Not thread-safe. The same views in the same order give the same bits.
class LandmarkFusion {
 public:
  /// Views come from an extractor with these ORB settings; features of a view beyond orb.num_features are ignored.
  LandmarkFusion(const Intrinsics& color, const DepthNoise& depth_noise, const OrbOptions& orb);

  void add_view(const FrameFeatures& view);

  [[nodiscard]] std::size_t num_landmarks() const { return landmarks_.size(); }
  [[nodiscard]] std::uint64_t num_observations() const { return num_observations_; }
  /// What each view saw, in the order of add_view.
  [[nodiscard]] const std::vector<std::vector<ViewObservation>>& views() const { return views_; }
  [[nodiscard]] const std::vector<Rigid3>& poses() const { return poses_; }

  /// All landmarks, with descriptors ordered by how many observations they stand for: the first is the medoid.
  /// `support[i][k]` is the number of sampled observations that descriptor k of landmark i stands for.
  [[nodiscard]] std::vector<MapLandmark> landmarks(std::vector<std::vector<std::uint32_t>>* support) const;

 private:
  static constexpr std::size_t kMaxSamples = 12;     ///< observations of a landmark whose descriptors are remembered
  static constexpr std::size_t kMaxDescriptors = 4;  ///< appearances a landmark may keep
  static constexpr int kAppearanceDistance = 48;     ///< farther than this from all appearances is a new one
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

  void gather_candidates(const FrameFeatures& view);
  void find_pairs(const FrameFeatures& view);
  void pair_landmark(const FrameFeatures& view, std::uint32_t index, const Eigen::Vector3d& p_camera);
  bool is_consistent(const Fused& landmark, double z_m, const FrameFeatures& view, std::size_t feature) const;
  std::int64_t find_new_landmark(const FrameFeatures& view, std::size_t feature) const;
  void observe(const FrameFeatures& view, std::size_t feature, std::uint32_t index);
  void widen_scale(const FrameFeatures& view, std::size_t feature, Fused* landmark) const;
  std::uint32_t create(const FrameFeatures& view, std::size_t feature);
  void add_appearance(const Keypoint& keypoint, const Descriptor& descriptor, std::uint32_t index);
  void choose_descriptors(const Fused& from, MapLandmark* to, std::vector<std::uint32_t>* support) const;
  void set_viewing_directions(std::vector<MapLandmark>* landmarks) const;
  [[nodiscard]] std::uint8_t cell_of(const Keypoint& keypoint) const;
  [[nodiscard]] float reference_m(const FrameFeatures& view, std::size_t feature) const;

  Intrinsics color_;
  DepthNoise depth_noise_;
  std::size_t max_features_;
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
