// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// RGB-D SLAM: where the camera was in every frame of a recording, from the frames alone. Keyframes, a local bundle adjustment with
// depth for each of them, loops closed on the way, everything adjusted at the end. Follows the outline of ORB-SLAM2 (Mur-Artal
// and Tardos, "ORB-SLAM2: an open-source SLAM system for monocular, stereo and RGB-D cameras", 2017), with depth as an
// observation of its own. One thread, no clock: the same frames and options give the same bits.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/dense/thumbnail.h"
#include "core/registration/frame_registration.h"
#include "core/slam/dense_links.h"
#include "core/slam/depth_bridge.h"
#include "core/slam/depth_weight.h"
#include "core/slam/loops/loop_closing.h"
#include "core/slam/loops/place_index.h"
#include "core/slam/map_adjustment.h"
#include "core/slam/map_uncertainty.h"
#include "core/slam/slam_map.h"
#include "core/slam/slam_numbers.h"
#include "core/slam/tracker.h"

namespace camloc {

struct SlamOptions {
  OrbOptions orb;  ///< what the features of the frames were made with
  SlamNumbers numbers;
  std::vector<std::uint64_t> required_keyframes;  ///< frames that become keyframes whatever they show, ascending
};

enum class ViewState : std::uint8_t { kTracked, kLost };

/// What became of one frame.
struct FrameReport {
  ViewState state = ViewState::kLost;
  std::uint32_t num_inliers = 0;
  bool is_keyframe = false;
  bool is_bridged = false;  ///< tracked, but by dense alignment: it shows too few features
  bool has_begun_segment = false;
  LoopReport loop;
};

struct SlamCounts {
  std::uint32_t num_views = 0, num_lost = 0, num_losses = 0;  ///< frames without pose; how often it happened
  std::uint32_t num_bridged = 0;                              ///< frames whose pose is from dense alignment
  std::uint32_t num_keyframes = 0, num_landmarks = 0;
  std::uint32_t num_loops = 0, num_loops_refused = 0, num_segments = 0, num_joined = 0;
};

/// A frame and where it was.
struct SlamPose {
  std::uint64_t frame = 0;
  std::int64_t stamp_ns = 0;
  std::uint32_t segment = 0;
  Rigid3 T_map_camera;  ///< in the frame of the segment
  std::uint32_t num_inliers = 0;
  bool is_keyframe = false;
};

struct SlamResult {
  std::vector<SlamPose> poses;  ///< of all tracked frames, in their order
  struct Segment {
    std::uint32_t id = 0;
    std::uint32_t num_keyframes = 0, num_views = 0;
    MapFit fit;
    MapUncertainty uncertainty;  ///< only where Slam::uncertainty() was asked
  };
  std::vector<Segment> segments;  ///< most frames first
};

/// Not thread-safe.
class Slam {
 public:
  Slam(const RgbdCamera& camera, const SlamOptions& options);

  /// The next frame; `frame` is its index in the recording, ascending. Patches are kept of those that become keyframes, until
  /// finish(). With thumbnails, stretches without features are bridged, and keyframes linked by all their pixels.
  FrameReport add_view(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail = {});
  [[nodiscard]] SlamCounts counts() const;

  [[nodiscard]] const SlamMap& map() const { return map_; }
  /// The keyframe that a frame has become, if it has.
  [[nodiscard]] std::optional<std::uint32_t> keyframe_of_frame(std::uint64_t frame) const;

  /// Adjusts everything; call it when all frames are there. `on_iteration` may stop the adjustment early.
  [[nodiscard]] SlamResult finish(const BundleCallback& on_iteration = {});
  /// Adjusts the segment of the first control landmark's keyframe once more, held by surveyed points; after finish().
  [[nodiscard]] SlamResult adjust_to(std::span<const ControlLandmark> controls, const BundleCallback& on_iteration = {});
  /// How much the poses of a segment may be bent, after the last adjustment. Costs about as much as that.
  [[nodiscard]] MapUncertainty uncertainty(std::uint32_t segment) const;

 private:
  /// A tracked frame, relative to a keyframe, with what it saw: enough to refine it once the landmarks are final.
  struct TrackedFrame {
    std::uint64_t frame = 0;
    std::int64_t stamp_ns = 0;
    std::uint32_t reference = 0;
    Rigid3 T_reference_camera;
    bool is_keyframe = false;
    struct Seen {
      std::uint32_t landmark;
      float x, y, depth_m, sigma_px;
    };
    std::vector<Seen> seen;
  };

  FrameReport place_view(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail);
  void begin_bridge(std::int64_t stamp_ns, const Thumbnail& thumbnail);
  bool go_on_by_depth(std::uint64_t frame, const FrameFeatures& view, const Thumbnail& thumbnail, FrameReport* report);
  std::uint32_t add_bridged_keyframe(std::uint64_t frame, FrameFeatures view, const Thumbnail& thumbnail, const DepthBridge::Step& step);
  bool begin_segment(std::uint64_t frame, FrameFeatures view, FrameReport* report);
  void add_keyframe(std::uint64_t frame, FrameFeatures view, const Registration& tracked, FrameReport* report);
  void adjust_around(std::uint32_t keyframe);
  void join_leftover_segments();
  void refine_all_observations();
  LoopReport look_for_loop(std::uint32_t keyframe);
  void remember(std::uint64_t frame, std::int64_t stamp_ns, bool is_keyframe, std::vector<TrackedFrame::Seen> seen = {});
  [[nodiscard]] std::vector<TrackedFrame::Seen> seen_in(const FrameFeatures& view, const std::vector<LandmarkObservation>& pairs) const;
  [[nodiscard]] BundleOptions bundle_options() const;
  [[nodiscard]] MapEvidence evidence(std::uint32_t segment) const;
  [[nodiscard]] SlamResult result() const;
  [[nodiscard]] Rigid3 final_pose(const TrackedFrame& view) const;

  RgbdCamera camera_;
  SlamOptions options_;
  SlamMap map_;
  PoseSolver solver_;
  PlaceIndex places_;
  Tracker tracker_;
  LoopCloser loops_;
  DepthBridge bridge_;
  DenseLinks links_;
  struct {
    std::uint32_t reference = 0;
    Rigid3 T_reference_camera;
  } bridge_begin_;  ///< the last frame that was tracked by its features
  DepthWeight depth_weight_;
  std::vector<TrackedFrame> tracked_;
  std::map<std::uint32_t, MapFit> fits_;   ///< of the segments, after finish()
  std::vector<ControlLandmark> controls_;  ///< of one segment, after adjust_to()
  std::uint32_t controlled_segment_ = 0;
  SlamCounts counts_;
  int num_lost_in_a_row_ = 0;
};

}  // namespace camloc
