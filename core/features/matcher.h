// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// From features to landmark matches, in two ways: guided, where a predicted pose says where in the image a landmark
// should be; and against candidates, where only the descriptor is known. Landmarks may have several descriptors.
// Nothing here knows the map: the caller says what a candidate descriptor belongs to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/features/descriptor.h"

namespace camloc {

struct Match {
  std::int32_t feature = -1;   ///< index into Features
  std::int32_t landmark = -1;  ///< the caller's id
  std::uint16_t distance = 0;  ///< Hamming distance
  /// Distance of the best rival: another landmark (candidates) or feature (guided); 257: none. The candidate matcher with its
  /// ratio test off also says 257 where the two best candidates belong to one landmark.
  std::uint16_t second = 257;
};

/// Buckets of keypoints for window queries. Allocates at construction only.
class FeatureGrid {
 public:
  FeatureGrid(int width, int height, int max_features, int cell_px = 24);
  /// Refills the buckets; features beyond max_features are ignored, features outside the image go to the nearest bucket.
  void assign(std::span<const Keypoint> keypoints);
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cell_px() const { return cell_px_; }
  /// Feature indices in one bucket.
  [[nodiscard]] std::span<const std::int32_t> bucket(int column, int row) const { return buckets(column, column, row); }
  /// Feature indices in neighbouring buckets of one row, first and last column included.
  [[nodiscard]] std::span<const std::int32_t> buckets(int first_column, int last_column, int row) const;
  /// All feature indices, bucket by bucket: what buckets() hands out are pieces of this.
  [[nodiscard]] std::span<const std::int32_t> all() const { return {feature_.data(), static_cast<std::size_t>(bucket_begin_.back())}; }

 private:
  [[nodiscard]] int bucket_of(const Keypoint& keypoint) const;

  int columns_, rows_, cell_px_, max_features_;
  std::vector<std::int32_t> bucket_begin_, feature_;
};

/// A landmark where the predicted pose puts it in the image.
struct ProjectedLandmark {
  std::int32_t landmark = -1;
  float u = 0, v = 0;                                       ///< predicted pixel
  float radius_px = 8;                                      ///< search window
  std::uint8_t min_level = 0, max_level = 7;                ///< pyramid levels it may appear on
  std::uint32_t first_descriptor = 0, num_descriptors = 1;  ///< range in the descriptors given to match()
};

struct GuidedMatcherOptions {
  int max_distance = 64;   ///< of 256 bits
  double max_ratio = 0.9;  ///< best / second best feature in the window on a nearby level; 1 = off
};

/// Best feature in the window of each projected landmark; a feature claimed by several landmarks goes to the closest
/// descriptor. Not thread-safe; allocates at construction only.
class GuidedMatcher {
 public:
  GuidedMatcher(const GuidedMatcherOptions& options, int max_features);
  /// Matches ordered by feature index; valid until the next call.
  std::span<const Match> match(const Features& features, const FeatureGrid& grid, std::span<const ProjectedLandmark> landmarks,
                               std::span<const Descriptor> descriptors);

 private:
  /// The frame's features in the order of the grid, so that a window is a few stretches of memory. A position is an index
  /// into these.
  struct FeatureTable {
    explicit FeatureTable(std::size_t max_features)
        : u(max_features), v(max_features), levels(max_features), features(max_features), descriptors(max_features) {}
    void assign(const Features& from, const FeatureGrid& grid);

    std::size_t size = 0;
    std::vector<float> u, v;
    std::vector<std::uint8_t> levels;
    std::vector<std::int32_t> features;
    std::vector<Descriptor> descriptors;
  };

  void collect_window(const FeatureGrid& grid, const ProjectedLandmark& landmark);
  void measure_window(std::span<const Descriptor> appearances);
  [[nodiscard]] Match best_in_window() const;

  GuidedMatcherOptions options_;
  std::vector<Match> best_of_feature_;
  std::vector<Match> matches_;
  FeatureTable table_;
  // The window of the landmark at hand: positions in the table, smallest distances, and those of one appearance.
  std::size_t window_size_ = 0;
  std::vector<std::uint32_t> window_;
  std::vector<std::uint16_t> distances_, appearance_distances_;
};

/// Candidate descriptors gathered from the map, structure of arrays. Capacity is fixed at construction.
struct CandidateSet {
  explicit CandidateSet(std::size_t capacity);
  bool add(const Descriptor& descriptor, std::int32_t landmark, float angle_rad);  ///< false when full
  void clear() { size = 0; }

  std::size_t size = 0;
  std::vector<Descriptor> descriptors;
  std::vector<std::int32_t> landmarks;
  std::vector<float> angles_rad;  ///< orientation of the landmark's feature where it was mapped
};

struct CandidateMatcherOptions {
  int max_distance = 64;
  double max_ratio = 1.0;                   ///< best / best of another landmark; 1 = off
  bool is_mutual = true;                    ///< the feature must also be the landmark's best
  double max_rotation_deviation_rad = 0.5;  ///< from the dominant rotation between mapped and seen orientation; <= 0 = off
};

/// Best candidate of each feature. The rival of the ratio test is the best descriptor of another landmark: a landmark's
/// own further appearances never count against it. Not thread-safe; allocates at construction only.
class CandidateMatcher {
 public:
  CandidateMatcher(const CandidateMatcherOptions& options, int max_features, std::size_t max_candidates);
  /// Matches ordered by feature index; valid until the next call.
  std::span<const Match> match(const Features& features, const CandidateSet& candidates);

 private:
  void find_best_candidates(const Features& features, const CandidateSet& candidates, std::size_t num_features);
  std::uint16_t rival_distance(const Descriptor& descriptor, const CandidateSet& candidates, std::int32_t landmark);
  void index_landmarks(const CandidateSet& candidates);
  [[nodiscard]] std::size_t slot_of(const CandidateSet& candidates, std::int32_t landmark) const;
  std::int32_t best_feature_of(std::size_t slot, const Features& features, const CandidateSet& candidates);
  void keep_mutual(const Features& features, const CandidateSet& candidates);
  void keep_dominant_rotation(const Features& features, const CandidateSet& candidates);

  CandidateMatcherOptions options_;
  std::vector<Match> matches_;
  std::vector<std::uint32_t> candidate_;  ///< of each match
  std::vector<double> rotations_rad_;     ///< of each match, from mapped to seen orientation
  std::vector<std::uint16_t> distances_;  ///< of one descriptor to all features or all candidates
  // Hash table from landmark to its candidates: slot -> first candidate, candidate -> next of the same landmark.
  std::vector<std::int32_t> first_in_slot_, next_candidate_;
  std::vector<std::int32_t> best_feature_in_slot_;  ///< -2: not computed yet
  std::size_t max_features_, max_candidates_;
};

}  // namespace camloc
