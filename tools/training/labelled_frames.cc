// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/labelled_frames.h"

#include <functional>
#include <optional>

#include "drivers/sources.h"
#include "tools/evaluation/sequence_run.h"
#include "tools/mapping/build/posed_frames.h"

namespace camloc::training {
namespace {

/// Where the camera was, if that is known.
using Labeller = std::function<std::optional<Rigid3>(const Frame&)>;

Result<LabelCounts> read_labelled(FrameSource& source, const Labeller& label, std::uint32_t recording, WorkObserver* observer,
                                  TrainingSet* set) {
  LabelCounts labelled;
  const std::uint64_t num_frames = source.info().num_frames.value_or(0);
  std::uint64_t num_done = 0;
  const auto take = [&](FrameBuffer& buffer) {
    const Frame frame = buffer.view();
    const std::optional<Rigid3> pose = label(frame);
    if (pose) set->add(frame, *pose, recording);
    ++(pose ? labelled.num_labelled : labelled.num_unlabelled);
    observer->show("frame", ++num_done, num_frames, std::to_string(labelled.num_labelled) + " with a pose");
    return Status::ok();
  };
  const auto counts = tools::read_frames(source, take, *observer);
  if (!counts) return counts.status();
  if (counts->are_all_corrupt()) return tools::all_frames_corrupt(*counts);
  if (observer->should_stop()) return {ErrorCode::kIo, "interrupted while the frames were read; nothing was trained"};
  labelled.num_unlabelled += counts->num_corrupt;
  return labelled;
}

/// The map localizes its own recording.
Result<LabelCounts> add_localized(const RecordingRequest& request, std::uint32_t recording, WorkObserver* observer, TrainingSet* set) {
  auto run = tools::open_sequence_run({.map_path = request.map_path,
                                       .sequence_url = request.sequence,
                                       .camera_path = request.camera_path,
                                       .frames = request.frames,
                                       .exclude = request.exclude});
  if (!run) return run.status();
  const Labeller label = [&](const Frame& frame) -> std::optional<Rigid3> {
    const Localization& result = run->localizer->process(frame);
    if (result.state != State::kLocalized) return std::nullopt;
    return result.T_map_camera;
  };
  return read_labelled(*run->source, label, recording, observer, set);
}

Result<LabelCounts> add_posed(const RecordingRequest& request, const RgbdCamera& camera, std::uint32_t recording, WorkObserver* observer,
                              TrainingSet* set) {
  const auto frames = mapping::find_posed_frames(
      {.sequence = request.sequence, .poses = request.poses, .include = request.frames, .exclude = request.exclude}, camera);
  if (!frames) return frames.status();
  auto source = open_frame_source(frames->url);
  if (!source) return source.status();
  const Labeller label = [&](const Frame& frame) -> std::optional<Rigid3> {
    const auto at = frames->T_map_camera_of_frame.find(frame.sequence);
    if (at == frames->T_map_camera_of_frame.end()) return std::nullopt;
    return at->second;
  };
  auto counts = read_labelled(**source, label, recording, observer, set);
  if (counts) counts->num_unlabelled += frames->num_without_pose;
  return counts;
}

}  // namespace

Result<LabelCounts> add_recording(const RecordingRequest& request, const RgbdCamera& camera, std::uint32_t recording,
                                  WorkObserver* observer, TrainingSet* set) {
  return request.poses.empty() ? add_localized(request, recording, observer, set) : add_posed(request, camera, recording, observer, set);
}

}  // namespace camloc::training
