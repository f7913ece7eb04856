// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What does not fit together is refused before the first frame: camera and images by size, texts that become part of a URL by syntax.
#include "tools/evaluation/sequence_run.h"

#include <chrono>

#include "core/io/camera_file.h"
#include "core/io/sequence.h"
#include "drivers/sources.h"
#include "tools/common/command_line.h"

namespace camloc::tools {
namespace {

Status check_sizes(const FrameSourceInfo& info, const RgbdCamera& camera, const std::string& camera_path) {
  if (info.color_width == 0) return Status::ok();  // a live source tells with its first frame
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  if (info.color_width != camera.color.width || info.color_height != camera.color.height) {
    return {ErrorCode::kInvalid, camera_path + ": is for " + size(camera.color.width, camera.color.height) +
                                     " colour images, the sequence has " + size(info.color_width, info.color_height) +
                                     ": use the camera file of the camera that recorded it"};
  }
  if (info.depth_width != 0 && (info.depth_width != camera.depth.width || info.depth_height != camera.depth.height)) {
    return {ErrorCode::kInvalid, camera_path + ": is for " + size(camera.depth.width, camera.depth.height) +
                                     " depth images, the sequence has " + size(info.depth_width, info.depth_height) +
                                     ": use the camera file of the camera that recorded it"};
  }
  return Status::ok();
}

/// "localizer.NAME=VALUE" into the numbers that the localizer weighs by.
Status set_localizer_number(const std::string& assignment, LocalizerNumbers* numbers) {
  constexpr std::string_view kGroup = "localizer.";
  const bool is_ours = assignment.starts_with(kGroup);
  const Status status = is_ours ? set_number(localizer_number_table(), std::string_view(assignment).substr(kGroup.size()), numbers)
                                : Status(ErrorCode::kInvalid, assignment + ": is not localizer.NAME=VALUE");
  return status.with_context("--set");
}

/// The text becomes part of a URL, so anything but slices must end here.
Status check_selection(const std::string& option, const std::string& text) {
  return text.empty() ? Status::ok() : select_frames(text, "", 1).status().with_context(option);
}

}  // namespace

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Result<SequenceRun> open_sequence_run(const SequenceRunOptions& options) {
  SequenceRun run;
  for (const std::string& text : options.perturbations) {
    auto perturbation = parse_perturbation(text);
    if (!perturbation) return perturbation.status();
    run.perturbations.push_back(*perturbation);
  }
  for (const std::string& assignment : options.numbers) {
    if (Status status = set_localizer_number(assignment, &run.localizer_options.numbers); !status) return status;
  }
  if (Status status = check_selection("--frames", options.frames); !status) return status;
  if (Status status = check_selection("--exclude", options.exclude); !status) return status;
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

  run.localizer_options.use_tracking = !options.is_single;
  run.localizer_options.use_depth = options.use_depth;
  run.localizer_options.now_ns = options.clock != nullptr ? options.clock : monotonic_ns;
  run.localizer = std::make_unique<Localizer>(*run.map, run.camera, run.localizer_options);
  return run;
}

Result<FrameCounts> read_perturbed_frames(SequenceRun& run, const std::function<void(const Frame&)>& on_frame,
                                          const WorkObserver& observer) {
  auto counts = read_frames(
      *run.source,
      [&](FrameBuffer& frame) {
        apply(run.perturbations, frame.sequence, &frame.gray);
        on_frame(frame.view());
        return Status::ok();
      },
      observer);
  if (counts && counts->are_all_corrupt()) return all_frames_corrupt(*counts);
  return counts;
}

void warn_of_corrupt_frames(const std::string& program, const FrameCounts& counts) {
  if (counts.num_corrupt == 0) return;
  print_error(program, std::to_string(counts.num_corrupt) + " of " + std::to_string(counts.num_frames) +
                           " frames could not be read and count as not localized, the first: " + counts.first_corrupt);
}

}  // namespace camloc::tools
