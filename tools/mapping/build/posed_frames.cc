// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/posed_frames.h"

#include <string_view>
#include <vector>

#include "core/io/sequence.h"
#include "drivers/source_url.h"
#include "tools/common/text_format.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

Result<std::string> folder_of(const std::string& url) {
  const auto parsed = parse_source_url(url);
  if (!parsed.is_ok()) return parsed.status();
  if (parsed->scheme != "replay") {
    return {ErrorCode::kInvalid, "--sequence " + url + ": a map is made from a recording; give replay://DIR or a folder"};
  }
  if (!parsed->options.empty()) {
    return {ErrorCode::kInvalid, "--sequence " + url + ": takes no parameters; choose frames with --frames, --exclude and --pair-ms"};
  }
  return parsed->path;
}

constexpr std::string_view kColmapScheme = "colmap:";

/// Per frame of the recording; sets `scale` where the poses had to be scaled.
Result<std::vector<std::optional<Rigid3>>> recorded_poses(const PosedFramesRequest& request, const Sequence& sequence,
                                                          const RgbdCamera& camera, std::optional<ModelScale>* scale,
                                                          std::vector<std::string>* notes) {
  if (request.poses == "embedded") return read_embedded_poses(sequence, notes);
  if (request.poses.starts_with(kColmapScheme)) {
    if (request.pose_camera == PoseCamera::kDepth) {
      return {ErrorCode::kInvalid, "--poses-of depth: a COLMAP model has the poses of colour images; leave it out"};
    }
    auto poses = read_colmap_poses(request.poses.substr(kColmapScheme.size()), sequence, camera);
    if (!poses.is_ok()) return poses.status();
    *scale = poses.value().scale;
    notes->insert(notes->end(), poses->notes.begin(), poses->notes.end());
    return std::move(poses.value().T_map_camera);
  }
  const auto trajectory = read_tum_trajectory(request.poses, notes);
  if (!trajectory.is_ok()) return trajectory.status();
  std::vector<std::optional<Rigid3>> result;
  for (const SequenceFrame& frame : sequence.frames) result.push_back(pose_at(trajectory.value(), frame.stamp_ns));
  return result;
}

// "start:stop:step" runs of equal distance, as short as that gets; `frames` ascends.
std::string slices_of(const std::vector<std::uint64_t>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    const std::uint64_t start = frames[i];
    std::uint64_t last = start, step = 1;
    if (++i < frames.size()) {
      step = frames[i] - start;
      for (; i < frames.size() && frames[i] == last + step; ++i) last = frames[i];
    }
    if (!text.empty()) text += ",";
    text += std::to_string(start) + ":" + std::to_string(last + 1) + ":" + std::to_string(step);
  }
  return text;
}

struct Selection : SelectedFrames {
  Sequence sequence;
  std::vector<std::size_t> frames;  ///< indices in the sequence, ascending
};

Result<Selection> select(const PosedFramesRequest& request) {
  const auto folder = folder_of(request.sequence);
  if (!folder.is_ok()) return folder.status();
  auto sequence = read_sequence(folder.value(), {.pair_ms = request.pair_ms});
  if (!sequence.is_ok()) return sequence.status();
  auto frames = select_frames(request.include, request.exclude, sequence->frames.size());
  if (!frames.is_ok()) return frames.status();
  Selection result{
      {*folder, "", sequence->frames.size(), frames->size(), false, {}}, std::move(sequence).value(), std::move(frames).value()};
  result.notes = result.sequence.notes;
  for (const SequenceFrame& frame : result.sequence.frames) result.has_depth = result.has_depth || !frame.depth_path.empty();
  return result;
}

}  // namespace

std::string recording_url(const PosedFramesRequest& request, const std::string& folder, const std::vector<std::uint64_t>& frames) {
  const bool is_usual = request.pair_ms == PosedFramesRequest{}.pair_ms;
  const std::string pairing = is_usual ? "" : tools::text_of("pair_ms=%.3f&", request.pair_ms);
  return replay_url(folder) + "?" + pairing + "frames=" + slices_of(frames);
}

Result<SelectedFrames> find_frames(const PosedFramesRequest& request) {
  auto selection = select(request);
  if (!selection.is_ok()) return selection.status();
  selection->url = recording_url(request, selection->folder, {selection->frames.begin(), selection->frames.end()});
  return SelectedFrames(*selection);
}

Result<PosedFrames> find_posed_frames(const PosedFramesRequest& request, const RgbdCamera& camera) {
  const auto selection = select(request);
  if (!selection.is_ok()) return selection.status();
  PosedFrames result{*selection, {}, {}, 0, {}};
  const auto poses = recorded_poses(request, selection->sequence, camera, &result.scale, &result.notes);
  if (!poses.is_ok()) return poses.status();

  const bool are_embedded = request.poses == "embedded";
  const bool are_of_depth = request.pose_camera == PoseCamera::kDepth ||
                            (request.pose_camera == PoseCamera::kAuto && are_embedded && camera.poses_are_of_depth_camera);
  const Rigid3 T_recorded_color = are_of_depth ? camera.T_color_depth.inverse() : Rigid3{};
  for (const std::size_t index : selection->frames) {
    if (const auto& T_map_recorded = poses.value()[index]) {
      result.T_map_camera_of_frame.emplace(index, *T_map_recorded * T_recorded_color);
      result.stamp_ns_of_frame.emplace(index, selection->sequence.frames[index].stamp_ns);
    } else {
      ++result.num_without_pose;
    }
  }
  if (result.T_map_camera_of_frame.empty()) {
    return {ErrorCode::kInvalid, request.sequence + ": none of the " + std::to_string(result.num_selected) +
                                     " selected frames has a pose in " + (are_embedded ? std::string("the recording") : request.poses) +
                                     "; check --frames and the stamps of --poses"};
  }
  std::vector<std::uint64_t> with_pose;
  for (const auto& [frame, T_map_camera] : result.T_map_camera_of_frame) with_pose.push_back(frame);
  result.url = recording_url(request, selection->folder, with_pose);
  return result;
}

}  // namespace camloc::mapping
