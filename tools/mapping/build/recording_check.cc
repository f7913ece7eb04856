// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording is judged twice: early, by its depth images alone, so that nobody waits an hour for a refusal; and at the end, by how
// far the camera moved. In between every frame leaves a note, and stretches of weak notes become spots with advice.
#include <algorithm>

#include "tools/common/text_format.h"
#include "tools/mapping/build/recording_tracking.h"

namespace camloc::mapping {
namespace {

constexpr std::uint64_t kEarlyFrames = 30;  // enough to tell a broken sensor from a lens cap at the start
constexpr double kMaxGapS = 0.5;            // a longer one between stamps is a jump
constexpr std::size_t kMinFeatures = 100, kMinWithDepth = 60;
constexpr int kMinInliers = 60;
constexpr double kMinMovedM = 0.05, kMinTurnedRad = 0.09;
constexpr std::uint64_t kMaxHole = 5;  // good frames inside a weak spot

/// All valid depths within one unit of each other?
bool is_constant(ImageView<std::uint16_t> depth, std::uint16_t* value) {
  std::uint16_t low = 65535, high = 0;
  for (int y = 0; y < depth.height; y += 4) {
    for (int x = 0; x < depth.width; x += 4) {
      const std::uint16_t d = depth.at(x, y);
      if (d == 0 || d == 65535) continue;
      low = std::min(low, d);
      high = std::max(high, d);
    }
  }
  *value = high;
  return low <= high && high - low <= 1;
}

struct Weakness {
  const char *what, *advice;
};
constexpr Weakness kTimeJump{"time jump", "frames are missing; record without gaps"},
    kLittleTexture{"little texture", "point the camera at furniture, posters, corners instead of bare walls"},
    kLittleDepth{"little depth", "keep 0.5 to 4 m away from surfaces; glass, black and sunlit ones give none"},
    kLost{"lost", "walk there again, slower, with the camera at what is known already"},
    kFewLandmarks{"few landmarks found again", "something moved or covered the view, or the camera was too fast: scan there again"};

/// Nothing where the frame is a good one.
const Weakness* weakness_of(const RecordingCheck::Note& note) {
  if (note.is_jump) return &kTimeJump;
  if (note.num_features < kMinFeatures) return &kLittleTexture;
  if (note.num_with_depth < kMinWithDepth) return &kLittleDepth;
  if (note.is_lost) return &kLost;
  return note.num_inliers < kMinInliers ? &kFewLandmarks : nullptr;
}

}  // namespace

void RecordingCheck::see_frame(const Frame& frame, std::size_t num_features, std::size_t num_with_depth) {
  std::uint16_t value = 0;
  if (is_constant(frame.depth, &value)) {
    ++num_constant_;
    constant_value_ = value;
  }
  see_view(frame.sequence, frame.stamp_ns, num_features, num_with_depth);
}

void RecordingCheck::see_view(std::uint64_t frame, std::int64_t stamp_ns, std::size_t num_features, std::size_t num_with_depth) {
  const bool is_jump = num_seen_ > 0 && 1e-9 * static_cast<double>(stamp_ns - last_stamp_ns_) > kMaxGapS;
  notes_.push_back({.frame = frame, .is_jump = is_jump, .num_features = num_features, .num_with_depth = num_with_depth});
  if (is_jump) ++num_jumps_;
  if (num_features > 0 && num_with_depth == 0) ++num_without_depth_;
  last_stamp_ns_ = stamp_ns;
  ++num_seen_;
}

void RecordingCheck::see_report(const FrameReport& report) {
  notes_.back().is_lost = report.state == ViewState::kLost;
  notes_.back().num_inliers = report.has_begun_segment ? 1000 : report.num_inliers;
}

Status RecordingCheck::early_verdict() const {
  if (num_seen_ < kEarlyFrames || num_seen_ > 2 * kEarlyFrames) return Status::ok();
  return verdict({});
}

Status RecordingCheck::verdict(const SlamResult& result) const {
  if (num_seen_ > 0 && num_constant_ * 10 >= num_seen_ * 9) {
    return {ErrorCode::kInvalid, "depth is the same everywhere (" + std::to_string(constant_value_) + " units) in " +
                                     std::to_string(num_constant_) + " of " + std::to_string(num_seen_) +
                                     " frames; is the depth camera covered, or are these no depth images?"};
  }
  if (num_seen_ > 0 && num_without_depth_ * 10 >= num_seen_ * 9) {
    return {ErrorCode::kInvalid, "no feature has depth in " + std::to_string(num_without_depth_) + " of " + std::to_string(num_seen_) +
                                     " frames; check depth_unit_m, the depth range and the registration in the camera file"};
  }
  if (result.poses.size() < 2) return Status::ok();
  double moved_m = 0, turned_rad = 0;
  const SlamPose& first = result.poses.front();
  for (const SlamPose& pose : result.poses) {
    if (pose.segment != first.segment) return Status::ok();
    moved_m = std::max(moved_m, (pose.T_map_camera.translation - first.T_map_camera.translation).norm());
    turned_rad = std::max(turned_rad, rotation_distance_rad(pose.T_map_camera.rotation, first.T_map_camera.rotation));
  }
  if (moved_m >= kMinMovedM || turned_rad >= kMinTurnedRad) return Status::ok();
  return {ErrorCode::kInvalid,
          tools::text_of("the camera stood still: it moved by %.1f cm and turned by %.1f deg in %zu frames; a map needs a walk",
                         100 * moved_m, tools::degrees(turned_rad), result.poses.size())};
}

std::vector<WeakSpot> RecordingCheck::weak_spots() const {
  std::vector<WeakSpot> spots;
  std::uint64_t last = 0;  // position in notes_ of the last weak frame
  for (std::uint64_t i = 0; i < notes_.size(); ++i) {
    const Weakness* weakness = weakness_of(notes_[i]);
    if (weakness == nullptr) continue;
    if (!spots.empty() && spots.back().what == weakness->what && i - last <= kMaxHole) {
      spots.back().last_frame = notes_[i].frame;
    } else {
      spots.push_back({notes_[i].frame, notes_[i].frame, weakness->what, weakness->advice});
    }
    last = i;
  }
  return spots;
}

}  // namespace camloc::mapping
