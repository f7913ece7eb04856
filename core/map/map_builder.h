// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map from posed RGB-D frames: features with depth become observations, observations of one point become a landmark,
// the views that together see all landmarks become the keyframes, the landmarks' descriptors become a vocabulary.
// Offline; allocates as it goes.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/camera.h"
#include "core/map/map_data.h"
#include "core/map/view_features.h"

namespace camloc {

struct MapBuildOptions {
  OrbOptions orb;
  std::uint64_t max_bytes = 0;   ///< of the file; 0 = no limit
  int num_words = 0;             ///< 0 = chosen from the number of landmarks
  double fuse_radius_px = 2.5;   ///< a feature this close to a projected landmark may be another view of it
  int fuse_max_distance = 64;    ///< and its descriptor must be this close
  int appearance_distance = 48;  ///< an observation farther than this from all of a landmark's descriptors adds one
  int max_descriptors_per_landmark = 4;
  int min_observations = 2;            ///< landmarks seen by fewer frames are dropped where others are enough
  int landmarks_per_view = 1000;       ///< a landmark is not needed where all views that see it have this many
  double max_bytes_per_landmark = 60;  ///< of the whole file: bounds the further descriptors
  int min_keyframe_gain = 20;          ///< a view that alone sees fewer landmarks is no keyframe; those landmarks go
};

struct MapBuildReport {
  std::uint32_t num_frames = 0, num_frames_skipped = 0;
  std::uint64_t num_observations = 0;
  std::uint32_t num_landmarks_before = 0, num_landmarks = 0;  ///< before and after pruning and the byte budget
  std::uint32_t num_keyframes_before = 0, num_keyframes = 0;  ///< views with landmarks, and the set that covers them all
  std::uint32_t num_descriptors = 0, num_words = 0;
  std::uint64_t file_bytes = 0;
  std::uint32_t num_consistency_pairs = 0;  ///< pairs of views behind MapData::pose_sigma_m and pose_sigma_rad
};

class MapBuilder {
 public:
  MapBuilder(const RgbdCamera& camera, const MapBuildOptions& options);
  ~MapBuilder();

  /// One view with its given pose. kInvalid when an image size does not fit the camera or the pose is not finite: the
  /// frame is skipped and counted, the builder goes on. A frame without depth is skipped, too.
  [[nodiscard]] Status add_frame(const Frame& frame, const Rigid3& T_map_camera);
  /// The same for a view whose features were extracted before (ViewExtractor, with the options' OrbOptions), pose included.
  void add_view(const ViewFeatures& view);
  /// Counts so far (frames, observations, landmarks before pruning), for a progress display.
  [[nodiscard]] MapBuildReport progress() const;
  /// Fuses, covers, prunes to the budget, trains the words. kInvalid when no landmark is left.
  [[nodiscard]] Result<MapData> finish(MapBuildReport* report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
