// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Which places of a map look alike: every keyframe is asked for in the rest of the map, by words, then by descriptors, then by the pose
// that the other place would explain it with. Only the last counts: repeated things confuse a descriptor, repeated places confuse a pose
// (Knopp, Sivic and Pajdla, "Avoiding confusing features in place recognition", 2010).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/work_observer.h"
#include "core/map/keyframe_view.h"
#include "core/map/look_alikes.h"
#include "core/map/map_view.h"
#include "core/map/retrieval.h"
#include "core/registration/pose_solver.h"

namespace camloc {

struct RivalSearchOptions {
  double distance_m = 3.0;         ///< another place is at least this far away
  double turn_rad = 1.047;         ///< or turned by this, and
  double max_common_share = 0.05;  ///< shares at most this part of the landmarks
  double same_point_m = 1.0;       ///< landmarks closer than this are the same thing mapped twice, no look-alike
  int max_compared = 5;            ///< most similar other places, each asked through one keyframe
  int max_match_distance = 48;     ///< of 256 bits, mutually nearest
  std::uint32_t min_matches = 0;   ///< with fewer no pose is looked for
};

/// A place elsewhere that explains a keyframe's view.
struct RivalPlace {
  std::uint32_t keyframe = 0;
  double matched_share = 0;  ///< of the descriptors that match mutually
  std::uint32_t num_matches = 0;
  std::uint32_t num_inliers = 0;  ///< matches that agree on one pose of this view at that place
  Rigid3 T_map_camera;            ///< that pose; identity without inliers
};

/// Not thread-safe. The same map gives the same bits. Map and data, of the same map, must outlive it.
class RivalSearch {
 public:
  RivalSearch(const MapView& map, const MapData& data, const RivalSearchOptions& options);
  /// What was compared, in the order of likeness.
  [[nodiscard]] std::vector<RivalPlace> find(std::uint32_t keyframe);
  [[nodiscard]] const KeyframeView& view(std::uint32_t keyframe) const { return views_[keyframe]; }

 private:
  /// Where the landmarks of a map are, for poses from matches that are known already.
  class Positions final : public LandmarkPositions {
   public:
    explicit Positions(const MapData& map) : map_(&map) {}
    [[nodiscard]] Eigen::Vector3f position_m(std::int32_t i) const override {
      return map_->landmarks[static_cast<std::size_t>(i)].position_m;
    }

   private:
    const MapData* map_;
  };
  RivalPlace compare(const KeyframeView& here, std::uint32_t rival_keyframe, std::uint64_t seed);

  Positions positions_;
  RivalSearchOptions options_;
  std::vector<KeyframeView> views_;
  int most_features_;
  Retriever retriever_;
  std::vector<NearestDescriptor> forward_, backward_;
  std::vector<Descriptor> asked_back_;
  std::vector<Match> matches_;
  PoseSolver solver_;
};

/// Adds to `data`, the unpacked `map`, what camloc::LookAlikes reads. False when `observer` stopped it; `data` is as it was then.
[[nodiscard]] bool add_look_alikes(const MapView& map, MapData* data, WorkObserver& observer);

}  // namespace camloc
