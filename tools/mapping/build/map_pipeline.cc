// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two ways to a map. With poses (build_from_poses): every posed frame goes into the map builder. Without (build_from_recording): SLAM
// finds the poses in a first pass that logs what it sees, the recording is placed in the site or turned upright, and a second pass over
// the log feeds the builder. Both end in finish_map, which writes, or merges into the map that is extended.
#include "tools/mapping/build/map_pipeline.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <unordered_map>

#include "core/io/file_bytes.h"
#include "core/map/map_writer.h"
#include "drivers/sources.h"
#include "tools/common/frame_reading.h"
#include "tools/common/trajectory_file.h"
#include "tools/mapping/build/frame_log.h"
#include "tools/mapping/build/map_upgrade.h"
#include "tools/mapping/build/merge_pipeline.h"
#include "tools/mapping/build/recording_tracking.h"

namespace camloc::mapping {
namespace {

/// A build that was stopped is finished all the same, with what there is.
class Finishing final : public WorkObserver {
 public:
  explicit Finishing(WorkObserver& watcher) : watcher_(watcher) {}
  void show(const std::string& what, std::uint64_t done, std::uint64_t total, const std::string& note) override {
    watcher_.show(what, done, total, note);
  }

 private:
  WorkObserver& watcher_;
};

constexpr std::uint32_t kMinSegmentKeyframes = 4;  // a shorter stretch is no sub-map

std::string folder_name(const std::string& folder) { return std::filesystem::weakly_canonical(folder).filename().string().substr(0, 63); }

/// out.cmap, out.2.cmap, out.3.cmap, ...
std::string segment_path(const std::string& map_path, std::size_t number) {
  if (number == 0) return map_path;
  const std::filesystem::path path(map_path);
  return (path.parent_path() / (path.stem().string() + "." + std::to_string(number + 1) + path.extension().string())).string();
}

std::string landmarks_note(const MapBuilder& builder) { return std::to_string(builder.progress().num_landmarks_before) + " landmarks"; }

/// What is going to be merged is chosen from once, after merging.
MapBuildOptions recording_options(const BuildRequest& request) {
  MapBuildOptions options = request.map;
  if (!request.extend_path.empty()) options.max_bytes = 0;
  return options;
}

Status extend_map(const BuildRequest& request, const MapData& recorded, WorkObserver& observer, BuildSummary* summary) {
  summary->merge.emplace().map_b = request.frames.sequence;
  MapMergeOptions options;
  options.map.max_bytes = request.map.max_bytes;
  return merge_into(request.extend_path, recorded, options, request.map_path, observer, &*summary->merge);
}

Status finish_map(const BuildRequest& request, const std::string& name, const std::string& path, const std::optional<WcsDatum>& datum,
                  const MapUncertainty& deformation, MapBuilder* builder, WorkObserver& observer, BuildSummary* summary) {
  observer.show("choosing landmarks and keyframes, training words ...", 0, 0, "");
  auto map = builder->finish(&summary->build);
  if (!map.is_ok()) return map.status();
  summary->consistency_sigma_m = map->pose_sigma_m;
  summary->consistency_sigma_rad = map->pose_sigma_rad;
  summary->deformation = deformation;
  if (summary->pose_verdict) {  // no map is better than its poses are from one frame to the next
    map->pose_sigma_m = std::max(map->pose_sigma_m, summary->pose_verdict->sigma_m);
    map->pose_sigma_rad = std::max(map->pose_sigma_rad, summary->pose_verdict->sigma_rad);
  }
  map->pose_sigma_m = std::hypot(map->pose_sigma_m, deformation.sigma_m);
  map->pose_sigma_rad = std::hypot(map->pose_sigma_rad, deformation.sigma_rad);
  map->name = name;
  map->wcs = datum;
  const bool is_extension = !request.extend_path.empty() && path == request.map_path;
  const Status written = is_extension ? extend_map(request, map.value(), observer, summary) : write_map(map.value(), path);
  if (!written.is_ok()) return written;
  if (!is_extension) {
    Finishing finishing(observer);
    if (Status status = upgrade_map(path, path, finishing); !status.is_ok()) return status;
  }
  summary->map_path = path;
  return Status::ok();
}

// --- Poses are given -------------------------------------------------------------------------------------------------

/// Feeds every posed frame to the builder. Broken frames are counted, a wrong image size ends the build.
Status add_frames(const PosedFrames& frames, MapBuilder* builder, WorkObserver& observer, BuildSummary* summary) {
  auto source = open_frame_source(frames.url);
  if (!source.is_ok()) return source.status();
  std::uint64_t done = 0;
  const auto add = [&](FrameBuffer& buffer) {
    observer.show("frame", ++done, frames.T_map_camera_of_frame.size(), landmarks_note(*builder));
    const auto pose = frames.T_map_camera_of_frame.find(buffer.sequence);
    if (pose == frames.T_map_camera_of_frame.end()) return Status::ok();
    if (!buffer.depth.pixels.empty() && buffer.depth.width > 0) return builder->add_frame(buffer.view(), pose->second);
    ++summary->num_without_depth;
    return Status::ok();
  };
  auto counts = tools::read_frames(*source.value(), add, observer);
  if (!counts) return counts.status();
  summary->reading = std::move(counts).value();
  return Status::ok();
}

/// A recording that has depth images, none of which belongs to a colour image, says so in its notes.
Status no_depth(const BuildRequest& request, const SelectedFrames& frames) {
  if (!frames.notes.empty()) return {ErrorCode::kInvalid, frames.notes.back() + "; a map needs depth"};
  return {ErrorCode::kInvalid, request.frames.sequence + ": has no depth images; a map needs depth"};
}

/// Refuses poses that the images contradict, unless they are to be believed.
Status judge_given_poses(const BuildRequest& request, const PosedFrames& frames, WorkObserver& observer, BuildSummary* summary) {
  auto verdict = check_poses(request.frames, frames, request.camera, request.map.orb, observer);
  if (!verdict.is_ok()) return verdict.status();
  summary->pose_verdict = std::move(verdict).value();
  if (!summary->pose_verdict->is_contradicted()) return Status::ok();
  const std::string what =
      describe_contradiction(*summary->pose_verdict, request.frames.poses == "embedded" ? frames.folder : request.frames.poses);
  if (!request.believes_poses) return {ErrorCode::kInvalid, what + "; --believe-poses makes a map of them nevertheless"};
  summary->notes.push_back("WARNING " + what);
  return Status::ok();
}

Status build_from_poses(const BuildRequest& request, WorkObserver& observer, BuildSummary* summary) {
  const auto frames = find_posed_frames(request.frames, request.camera);
  if (!frames.is_ok()) return frames.status();
  summary->num_recorded = frames->num_recorded;
  summary->num_selected = frames->num_selected;
  summary->num_without_pose = frames->num_without_pose;
  summary->notes = frames->notes;
  if (!frames->has_depth) return no_depth(request, *frames);
  summary->model_scale = frames->scale;
  if (Status judged = judge_given_poses(request, *frames, observer, summary); !judged.is_ok()) return judged;
  if (observer.should_stop()) return interrupted(request.map_path);
  MapBuilder builder(request.camera, recording_options(request));
  if (const Status added = add_frames(frames.value(), &builder, observer, summary); !added.is_ok()) return added;
  if (observer.should_stop()) return interrupted(request.map_path);
  if (summary->reading.are_all_corrupt()) return tools::all_frames_corrupt(summary->reading);
  return finish_map(request, request.name.empty() ? folder_name(frames->folder) : request.name, request.map_path, std::nullopt, {},
                    &builder, observer, summary);
}

// --- SLAM finds the poses --------------------------------------------------------------------------------------------

struct TrackedRecording {
  SelectedFrames frames;
  TrackingRequest pass;
  std::optional<Survey> survey;
  RecordingEnd end;
  SlamResult result;              ///< where the camera was
  std::optional<WcsDatum> datum;  ///< where the largest segment lies in the site
};

Result<TrackedRecording> prepare_recording(const BuildRequest& request, BuildSummary* summary) {
  TrackedRecording recording;
  const auto frames = find_frames(request.frames);
  if (!frames.is_ok()) return frames.status();
  if (!frames->has_depth) return no_depth(request, *frames);
  summary->notes = frames->notes;
  recording.frames = frames.value();
  SlamOptions slam = request.slam;
  slam.orb = request.map.orb;
  if (!request.survey.points_path.empty()) {
    auto survey = read_survey(request.survey, recording.frames.folder, request.camera, request.frames.pair_ms);
    if (!survey.is_ok()) return survey.status();
    recording.survey = std::move(survey).value();
    slam.required_keyframes = frames_of(*recording.survey);
  }
  recording.pass = {
      recording.frames.url, recording.frames.num_selected, request.camera, request.map.orb, slam, frame_log_path(request.map_path),
      request.is_resumed};
  return recording;
}

/// The first pass, and everything that is known only after it: poses, refusals, weak spots.
Status find_poses(const BuildRequest& request, Slam* slam, TrackedRecording* recording, WorkObserver& observer, BuildSummary* summary) {
  RecordingCheck check(request.camera);
  auto end = track_recording(recording->pass, slam, &check, observer);
  if (!end.is_ok()) return end.status();
  recording->end = std::move(end).value();
  // A map that is extended is not touched by half a recording.
  if (recording->end.is_interrupted && !request.extend_path.empty()) return interrupted(request.map_path);
  summary->is_partial = recording->end.is_interrupted;
  summary->reading = recording->end.reading;
  summary->num_without_depth = recording->end.num_without_depth;
  recording->result = slam->finish([&](int iteration, double) {
    observer.show("adjusting all keyframes and landmarks, iteration " + std::to_string(iteration) + " ...", 0, 0, "");
    return true;
  });
  Status usable = check.verdict(recording->result);
  if (summary->reading.are_all_corrupt()) usable = tools::all_frames_corrupt(summary->reading);
  if (usable.is_ok() && recording->result.segments.empty())
    usable = {ErrorCode::kInvalid, request.frames.sequence + ": no frame shows enough texture with depth to begin a map"};
  if (!usable.is_ok()) {
    if (recording->end.is_interrupted) return interrupted(request.map_path);  // too early to tell, --resume will
    std::filesystem::remove(recording->pass.log_path);
    return usable;
  }
  summary->slam = SlamSummary{
      slam->counts(), recording->result.segments.front().fit, check.weak_spots(), check.num_stamp_jumps(), recording->end.num_resumed, "",
      std::nullopt};
  return Status::ok();
}

Status place_recording(const BuildRequest& request, Slam* slam, TrackedRecording* recording, BuildSummary* summary) {
  if (recording->survey) {
    summary->survey.emplace();
    summary->survey->map_path = summary->survey->out_path = request.map_path;
    recording->datum = adjust_to_survey(request.survey, *recording->survey, request.camera, slam, &recording->result, &*summary->survey);
    summary->survey->is_written = recording->datum.has_value();
    summary->slam->fit = recording->result.segments.front().fit;
    if (recording->datum) return Status::ok();
  }
  if (!request.is_levelled) return Status::ok();
  const auto up = find_up(recording->result, recording->end.surfaces, recording->frames.folder, request.accelerometer_path);
  if (!up.is_ok()) {
    summary->slam->up_problem = up.status().message();
    return request.accelerometer_path.empty() ? Status::ok() : up.status();
  }
  level(up->up_map, recording->result.segments.front().id, &recording->result);
  summary->slam->up = up.value();
  return Status::ok();
}

/// What every pose in the maps will be uncertain by.
void measure_deformation(const Slam& slam, WorkObserver& observer, SlamResult* result) {
  observer.show("comparing maps of half of the observations each ...", 0, 0, "");
  for (SlamResult::Segment& segment : result->segments) {
    if (segment.num_keyframes >= kMinSegmentKeyframes) segment.uncertainty = slam.uncertainty(segment.id);
  }
}

/// The second pass: what was seen, from where it was seen, becomes a map.
Status map_segment(const BuildRequest& request, const TrackedRecording& recording, std::size_t number, WorkObserver& observer,
                   BuildSummary* summary) {
  std::unordered_map<std::uint64_t, const SlamPose*> pose_of_frame;
  for (const SlamPose& pose : recording.result.poses) {
    if (pose.segment == recording.result.segments[number].id) pose_of_frame.emplace(pose.frame, &pose);
  }
  auto log = FrameLogReader::open(recording.pass.log_path, recording_identity(recording.pass));
  if (!log.is_ok()) return log.status();
  MapBuilder builder(request.camera, recording_options(request));
  LoggedFrame logged;
  std::uint64_t done = 0;
  while (log->next(&logged).is_ok()) {
    const auto pose = pose_of_frame.find(logged.frame);
    if (pose == pose_of_frame.end()) continue;
    logged.view.T_map_camera = pose->second->T_map_camera;
    builder.add_view(logged.view);
    observer.show("mapping view", ++done, pose_of_frame.size(), landmarks_note(builder));
  }
  if (done < pose_of_frame.size()) {
    return {ErrorCode::kCorrupt, recording.pass.log_path + ": holds " + std::to_string(done) + " of " +
                                     std::to_string(pose_of_frame.size()) + " views; is another build of the same map running?"};
  }
  const std::string name = request.name.empty() ? folder_name(recording.frames.folder) : request.name;
  return finish_map(request, name, segment_path(request.map_path, number), number == 0 ? recording.datum : std::nullopt,
                    recording.result.segments[number].uncertainty, &builder, observer, summary);
}

/// One map a segment, the largest at the path the user asked for. Returns an error only for that one.
Status write_segments(const BuildRequest& request, const TrackedRecording& recording, WorkObserver& observer, BuildSummary* summary) {
  for (std::size_t number = recording.result.segments.size(); number-- > 0;) {
    const SlamResult::Segment& segment = recording.result.segments[number];
    if (number == 0) return map_segment(request, recording, number, observer, summary);
    SubmapSummary submap{"", segment.num_keyframes, segment.num_views};
    if (segment.num_keyframes >= kMinSegmentKeyframes) {
      BuildSummary of_segment;
      if (map_segment(request, recording, number, observer, &of_segment).is_ok()) submap.map_path = of_segment.map_path;
    }
    summary->submaps.push_back(submap);
  }
  return Status::ok();
}

Status write_trajectory(const BuildRequest& request, const SlamResult& result, std::uint64_t num_frames) {
  if (request.trajectory_path.empty() || result.segments.empty()) return Status::ok();
  tools::EstimatedTrajectory trajectory;
  trajectory.num_frames = num_frames;
  if (request.camera.poses_are_of_depth_camera) trajectory.T_color_depth = request.camera.T_color_depth;
  for (const SlamPose& pose : result.poses) {
    if (pose.segment == result.segments.front().id) trajectory.poses.push_back({pose.stamp_ns, pose.T_map_camera, std::nullopt});
  }
  return replace_file(request.trajectory_path, format_trajectory(trajectory));
}

Status build_from_recording(const BuildRequest& request, WorkObserver& observer, BuildSummary* summary) {
  auto prepared = prepare_recording(request, summary);
  if (!prepared.is_ok()) return prepared.status();
  TrackedRecording recording = std::move(prepared).value();
  const auto log_lock = lock_frame_log(recording.pass.log_path);
  if (!log_lock.is_ok()) return log_lock.status();
  summary->num_recorded = recording.frames.num_recorded;
  summary->num_selected = recording.frames.num_selected;
  {
    Slam slam(request.camera, recording.pass.slam);  // gone before the map takes its place in memory
    if (const Status found = find_poses(request, &slam, &recording, observer, summary); !found.is_ok()) return found;
    if (const Status placed = place_recording(request, &slam, &recording, summary); !placed.is_ok()) return placed;
    measure_deformation(slam, observer, &recording.result);
  }
  if (const Status written = write_segments(request, recording, observer, summary); !written.is_ok()) return written;
  if (const Status written = write_trajectory(request, recording.result, summary->slam->counts.num_views); !written.is_ok()) return written;
  if (!summary->is_partial) std::filesystem::remove(recording.pass.log_path);
  return Status::ok();
}

}  // namespace

std::string frame_log_path(const std::string& map_path) { return map_path + ".views"; }

Status build_map(const BuildRequest& request, WorkObserver& observer, BuildSummary* summary) {
  const auto start = std::chrono::steady_clock::now();
  summary->map_path = request.map_path;
  summary->sequence = request.frames.sequence;
  summary->camera = request.camera.name;
  const Status built =
      request.frames.poses.empty() ? build_from_recording(request, observer, summary) : build_from_poses(request, observer, summary);
  summary->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return built;
}

}  // namespace camloc::mapping
