// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The pose of a view among landmarks: guided by a prediction, or from descriptors alone. Tracking, finding back after a loss
// and loop closure all ask this.
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/correspondences.h"
#include "core/geometry/pnp_ransac.h"
#include "core/geometry/pose_refinement.h"
#include "core/slam/landmark_set.h"

namespace camloc {

struct RegistrationOptions {
  bool use_depth = true;  ///< measured depth takes part in the pose
  int max_features = 1000;
  int guided_distance = 64;  ///< Hamming
  double guided_ratio = 0.9;
  float fine_radius_px = 6;   ///< window of the second look, around the pose of the first
  double max_error_px = 4.0;  ///< of an inlier
  int min_inliers = 20;
};

struct RegisteredPair {
  std::uint32_t landmark = 0, feature = 0;  ///< index in the SlamMap; in the view
};

struct Registration {
  bool is_found = false;
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Identity();
  int num_visible = 0;  ///< landmarks that should be in the image
  int num_matches = 0;  ///< of those, found in their window
  double median_px = 0;
  double depth_agreement = 1;  ///< share of inliers with depth whose depth agrees
  double spread = 0;           ///< share of the image's 8 x 6 cells that hold an inlier
  std::vector<RegisteredPair> inliers;
  [[nodiscard]] int num_inliers() const { return static_cast<int>(inliers.size()); }
  [[nodiscard]] double inlier_ratio() const { return num_matches == 0 ? 0 : static_cast<double>(num_inliers()) / num_matches; }
};

/// When a registration to a place far back in time is believed: looks alone are not enough, buildings repeat themselves.
struct PlaceLimits {
  int min_inliers = 40;
  double min_inlier_ratio = 0.4, min_depth_agreement = 0.7, min_spread = 0.15;
  double max_rival_share = 0.6;                           ///< inliers of another place, as a share of the best
  double rival_distance_m = 0.5, rival_angle_rad = 0.35;  ///< another place lies at least this far from the best
};

/// Enough landmarks fit, with pixels and with depth, spread over the image.
[[nodiscard]] bool is_convincing(const Registration& found, const PlaceLimits& limits);
/// `other` explains the view nearly as well as `best`, from another pose in the same frame.
[[nodiscard]] bool is_rival(const Registration& other, const Registration& best, const PlaceLimits& limits);

/// Not thread-safe. The same input gives the same bits.
class ViewRegistration {
 public:
  ViewRegistration(const RgbdCamera& camera, float scale_factor, const RegistrationOptions& options);

  /// Looks for landmarks within `radius_px` of where a camera at `T_map_camera_predicted` would see them.
  [[nodiscard]] Registration guided(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera_predicted, float radius_px,
                                    std::uint64_t seed);
  /// From descriptors alone, then guided by what was found.
  [[nodiscard]] Registration unguided(const ViewFeatures& view, LandmarkSet* landmarks, std::uint64_t seed);
  /// Only the matching of `guided`: features in windows around the prediction, without a pose. Valid until the next call.
  [[nodiscard]] std::span<const Match> matches_around(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera,
                                                      float radius_px);

 private:
  void fill_pairs(const ViewFeatures& view, const LandmarkSet& landmarks, std::span<const Match> matches);
  [[nodiscard]] bool solve(std::uint64_t seed, Rigid3* T_map_camera);
  [[nodiscard]] Registration look_again(const ViewFeatures& view, LandmarkSet* landmarks, const Rigid3& T_map_camera);

  RgbdCamera camera_;
  RegistrationOptions options_;
  double focal_px_;
  std::vector<float> scale_;
  FeatureGrid grid_;
  GuidedMatcher guided_;
  CandidateMatcher candidate_matcher_;
  CandidateSet candidates_;
  PnpRansac ransac_;
  Correspondences pairs_;
  std::vector<std::uint8_t> inlier_mask_;
  int num_visible_ = 0;
};

}  // namespace camloc
