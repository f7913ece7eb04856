// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc/sequence_run.h"

#include <chrono>

#include "drivers/camera_file.h"
#include "drivers/frame_selection.h"

namespace camloc::tools {
namespace {

Status check_sizes(const FrameSourceInfo& info, const RgbdCamera& camera, const std::string& camera_path) {
  if (info.color_width == 0) return Status::ok();  // a live source tells with its first frame
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  if (info.color_width != camera.color.width || info.color_height != camera.color.height) {
    return {ErrorCode::kInvalid, camera_path + ": is for " + size(camera.color.width, camera.color.height) + " colour images, the sequence has " +
                                     size(info.color_width, info.color_height) + ": use the camera file of the camera that recorded it"};
  }
  if (info.depth_width != 0 && (info.depth_width != camera.depth.width || info.depth_height != camera.depth.height)) {
    return {ErrorCode::kInvalid, camera_path + ": is for " + size(camera.depth.width, camera.depth.height) + " depth images, the sequence has " +
                                     size(info.depth_width, info.depth_height) + ": use the camera file of the camera that recorded it"};
  }
  return Status::ok();
}

}  // namespace

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string with_selection(const std::string& url, const std::string& frames, const std::string& exclude) {
  std::string out = url;
  const auto add = [&out](const std::string& key, const std::string& value) {
    if (value.empty()) return;
    out += (out.find('?') == std::string::npos ? "?" : "&") + key + "=" + value;
  };
  add("frames", frames);
  add("exclude", exclude);
  return out;
}

Result<SequenceRun> open_sequence_run(const SequenceRunOptions& options) {
  SequenceRun run;
  for (const std::string& text : options.perturbations) {
    auto perturbation = parse_perturbation(text);
    if (!perturbation) return perturbation.status();
    run.perturbations.push_back(*perturbation);
  }
  auto camera = read_camera_file(options.camera_path);
  if (!camera) return camera.status();
  run.camera = std::move(camera).value();
  auto map = MapView::open(options.map_path);
  if (!map) return map.status();
  run.map = std::make_unique<MapView>(std::move(map).value());
  auto source = open_frame_source(with_selection(options.sequence_url, options.frames, options.exclude));
  if (!source) return source.status();
  run.source = std::move(source).value();
  if (Status status = check_sizes(run.source->info(), run.camera, options.camera_path); !status) return status;

  LocalizerOptions localizer;
  localizer.use_tracking = !options.is_single;
  localizer.use_depth = options.use_depth;
  localizer.now_ns = monotonic_ns;
  run.localizer = std::make_unique<Localizer>(*run.map, run.camera, localizer);
  return run;
}

Result<RunCounts> for_each_frame(SequenceRun& run, const std::function<void(const Frame&)>& on_frame) {
  RunCounts counts;
  FrameBuffer buffer;
  while (true) {
    const Status status = run.source->next(&buffer, std::chrono::milliseconds(1000));
    if (status.code() == ErrorCode::kEnd) return counts;
    if (status.code() == ErrorCode::kTimeout) continue;
    if (status.code() == ErrorCode::kCorrupt) {
      ++counts.num_frames;
      ++counts.num_corrupt;
      continue;
    }
    if (!status) return status;
    ++counts.num_frames;
    apply(run.perturbations, buffer.sequence, &buffer.gray);
    on_frame(buffer.view());
  }
}

}  // namespace camloc::tools
