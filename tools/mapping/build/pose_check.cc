// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/pose_check.h"

#include <algorithm>
#include <map>
#include <vector>

#include "core/mapmaking/pose_consistency.h"
#include "core/registration/frame_features.h"
#include "drivers/source_url.h"
#include "drivers/sources.h"
#include "tools/common/frame_reading.h"
#include "tools/common/text_format.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxPairs = 40;
constexpr std::int64_t kWantedNs = 250'000'000, kMaxNs = 1'000'000'000;  // between the frames of a pair
constexpr double kMinInlierRatio = 0.4;

struct FramePair {
  std::size_t from, to;  ///< indices of the given poses
};

/// Evenly over the recording; each with the first frame that is a quarter of a second later.
std::vector<FramePair> choose_pairs(const std::vector<GivenPose>& poses) {
  std::vector<FramePair> pairs;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto is_later = [&](const GivenPose& pose) { return pose.stamp_ns >= poses[i].stamp_ns + kWantedNs; };
    const auto to = std::find_if(poses.begin() + static_cast<std::ptrdiff_t>(i) + 1, poses.end(), is_later);
    if (to != poses.end() && to->stamp_ns - poses[i].stamp_ns <= kMaxNs) pairs.push_back({i, static_cast<std::size_t>(to - poses.begin())});
  }
  if (pairs.size() <= kMaxPairs) return pairs;
  std::vector<FramePair> chosen;
  for (std::size_t i = 0; i < kMaxPairs; ++i) chosen.push_back(pairs[i * pairs.size() / kMaxPairs]);
  return chosen;
}

}  // namespace

Result<PoseVerdict> check_poses(const PosedFramesRequest& request, const PosedFrames& frames, const RgbdCamera& camera,
                                const OrbOptions& orb, WorkObserver& observer) {
  std::vector<GivenPose> poses;
  std::vector<std::uint64_t> frame_of_pose;
  for (const auto& [frame, T_map_camera] : frames.T_map_camera_of_frame) {
    poses.push_back({frames.stamp_ns_of_frame.at(frame), T_map_camera});
    frame_of_pose.push_back(frame);
  }
  const std::vector<FramePair> pairs = choose_pairs(poses);
  std::map<std::uint64_t, std::size_t> wanted;  // frame > pose
  for (const FramePair& pair : pairs) wanted[frame_of_pose[pair.from]] = pair.from, wanted[frame_of_pose[pair.to]] = pair.to;
  if (wanted.empty()) return PoseVerdict{};
  std::vector<std::uint64_t> selected;
  for (const auto& [frame, pose] : wanted) selected.push_back(frame);
  auto source = open_frame_source(recording_url(request, frames.folder, selected));
  if (!source.is_ok()) return source.status();
  FrameExtractor extractor(camera, orb);
  std::map<std::size_t, FrameFeatures> views;
  observer.show("comparing the poses with the images ...", 0, 0, "");
  const auto extract = [&](FrameBuffer& buffer) {
    const auto pose = wanted.find(buffer.sequence);
    if (pose != wanted.end() && extractor.check(buffer.view()).is_ok()) extractor.extract(buffer.view(), &views[pose->second]);
    return Status::ok();
  };
  if (auto counts = tools::read_frames(*source.value(), extract, observer); !counts) return counts.status();
  const PoseConsistencyOptions options;
  PoseSolver solver(camera, PyramidLevels(orb.scale_factor, orb.num_levels), pair_solver_options(options));
  std::vector<SeenMotion> motions;
  for (const FramePair& pair : pairs) {
    const auto from = views.find(pair.from), to = views.find(pair.to);
    if (from == views.end() || to == views.end()) continue;
    const PoseEvidence seen = register_views(from->second, to->second, motions.size(), &solver);
    const bool is_certain =
        seen.is_found && seen.num_inliers >= static_cast<std::uint32_t>(options.min_inliers) && seen.inlier_ratio() >= kMinInlierRatio;
    if (is_certain) motions.push_back({pair.from, pair.to, seen.T_map_camera});
  }
  return judge_poses(poses, motions);
}

std::string describe_contradiction(const PoseVerdict& verdict, const std::string& poses) {
  const PoseMisfit& given = verdict.given;
  std::string text =
      poses + tools::text_of(
                  ": the poses contradict the images: in %zu pairs of neighbouring frames, which moved by %.1f cm and turned by %.1f deg, "
                  "they are off by %.1f cm and %.1f deg (medians). ",
                  verdict.num_motions, 100 * verdict.moved_m, tools::degrees(verdict.turned_rad), 100 * given.translation_m,
                  tools::degrees(given.rotation_rad));
  if (verdict.fitting) {
    text += tools::text_of("They fit to %.1f cm and %.1f deg ", 100 * verdict.fitting->translation_m,
                           tools::degrees(verdict.fitting->rotation_rad)) +
            verdict.explanation;
  } else {
    text +=
        "No other reading of them fits (inverted, quaternion order, axes, clock, unit); are they of this recording and this camera, and is "
        "the camera "
        "file right?";
  }
  return text;
}

}  // namespace camloc::mapping
