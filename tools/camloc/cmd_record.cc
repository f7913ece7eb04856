// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc record`: a camera, or any other frame source, to a folder that replay:// and `camloc map build` read.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/io/camera_file.h"
#include "drivers/source_url.h"
#include "drivers/sources.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"
#include "tools/recording/recorder.h"

namespace camloc::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kFooter =
    "Depth keeps every bit, and so does the image unless --jpeg is given. Stamps are seconds since the epoch, at the exposure.\n"
    "Ctrl-C ends a recording; the folder is whole at every moment. Exit code: 0 done, 1 incomplete (frames dropped, disk full,\n"
    "camera gone), 2 wrong usage or configuration.\n"
    "Example: camloc record --source kinect:// --out walk --seconds 120";

struct RecordArguments {
  std::string source_url, out_path, camera_path;
  RecordingFormat format;
  std::uint64_t min_free_mb = 256;
  RecorderOptions options;
  bool replaces_old = false;
};

/// The line on the terminal, and a line of its own, once a second at most, when frames are being dropped.
class RecordingDisplay {
 public:
  explicit RecordingDisplay(std::uint64_t num_frames) : line_(num_frames), start_(Clock::now()) {}

  void show(const RecorderProgress& progress) {
    const auto now = Clock::now();
    if (progress.dropped > told_dropped_ && now - last_told_ > std::chrono::seconds(1)) {
      line_.say("");
      print_error("camloc", text_of("writing is slower than the camera: %llu frames dropped so far", llu(progress.dropped)));
      told_dropped_ = progress.dropped;
      last_told_ = now;
    }
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double rate_hz = seconds > 0 ? static_cast<double>(progress.frames) / seconds : 0;
    line_.show(progress.frames, text_of("%.1f Hz  %.1f MB/s  dropped %llu  queued %d  %.1f GB free", rate_hz,
                                        seconds > 0 ? 1e-6 * static_cast<double>(progress.bytes) / seconds : 0, llu(progress.dropped),
                                        progress.queued, 1e-9 * static_cast<double>(progress.free_bytes)));
  }

 private:
  ProgressLine line_;
  Clock::time_point start_, last_told_;
  std::uint64_t told_dropped_ = 0;
};

/// A recording must not be written over itself.
Status check_not_the_source(const RecordArguments& arguments) {
  const Result<SourceUrl> url = parse_source_url(arguments.source_url);
  std::error_code error;
  if (!url || url->scheme != "replay" || !std::filesystem::equivalent(url->path, arguments.out_path, error)) return Status::ok();
  return {ErrorCode::kInvalid, "--out " + arguments.out_path + ": is the source; choose another folder"};
}

Status check_space(const RecordArguments& arguments) {
  const Result<std::uint64_t> free_bytes = free_bytes_at(arguments.out_path);
  if (!free_bytes) return free_bytes.status();
  if (*free_bytes >= arguments.options.min_free_bytes) return Status::ok();
  return {ErrorCode::kIo, text_of("--out %s: %llu MB free on the disk, of which %llu stay free; free some, or lower --min-free",
                                  arguments.out_path.c_str(), llu(*free_bytes / 1'000'000), llu(arguments.min_free_mb))};
}

void print_summary(const RecordingSummary& summary, const std::string& path) {
  std::printf("%s: %llu frames, %llu with depth, %.1f s, %.1f MB%s\n", path.c_str(), llu(summary.frames), llu(summary.frames_with_depth),
              summary.seconds, 1e-6 * static_cast<double>(summary.bytes), summary.dropped + summary.unwritten == 0 ? ", none dropped" : "");
  const std::pair<const char*, std::uint64_t> counts[] = {{"dropped", summary.dropped},
                                                          {"not written", summary.unwritten},
                                                          {"missed", summary.missed},
                                                          {"corrupt", summary.corrupt},
                                                          {"out of order", summary.disordered},
                                                          {"incomplete", summary.health.frames_incomplete},
                                                          {"unpaired", summary.health.frames_unpaired},
                                                          {"lost packets", summary.health.packets_lost},
                                                          {"acceleration", summary.accelerations}};
  for (const auto& [what, count] : counts) {
    if (count > 0) std::printf("  %-12s %llu\n", what, llu(count));
  }
  if (!summary.has_camera)
    std::printf("  no camera.toml: the source knows no calibration; copy yours there, or use 'camloc camera calibrate'\n");
}

Status outcome(const RecordingSummary& summary, const std::string& path) {
  if (!summary.end) return summary.end;
  if (summary.frames == 0) return {ErrorCode::kEnd, path + ": no frame was recorded"};
  if (summary.dropped + summary.unwritten == 0) return Status::ok();
  return {ErrorCode::kIo,
          text_of("%s: incomplete, %llu frames dropped because writing was too slow; use --jpeg, a faster disk or a larger --queue",
                  path.c_str(), llu(summary.dropped + summary.unwritten))};
}

Status run(RecordArguments arguments) {
  arguments.options.min_free_bytes = arguments.min_free_mb * 1'000'000;
  if (Status status = check_not_the_source(arguments); !status) return status;
  if (Status status = check_space(arguments); !status) return status;
  if (!arguments.camera_path.empty()) {
    const Result<RgbdCamera> camera = read_camera_file(arguments.camera_path);
    if (!camera) return camera.status();
    arguments.options.camera = *camera;
  }
  auto source = open_frame_source(arguments.source_url, {arguments.format.is_color});
  if (!source) return source.status();
  Result<RecordingFolder> folder = RecordingFolder::create(arguments.out_path, arguments.format, arguments.replaces_old);
  if (!folder) return folder.status();

  const InterruptGuard guard;
  RecordingSummary summary;
  {
    RecordingDisplay display(arguments.options.max_frames.value_or((*source)->info().num_frames.value_or(0)));
    RecorderHooks hooks;
    hooks.is_interrupted = &InterruptGuard::is_interrupted;
    hooks.on_progress = [&display](const RecorderProgress& progress) { display.show(progress); };
    summary = record(source->get(), &*folder, arguments.format, arguments.options, hooks);
  }
  if (summary.frames == 0) {
    folder->discard();
  } else {
    print_summary(summary, arguments.out_path);
  }
  return outcome(summary, arguments.out_path);
}

}  // namespace

void add_record_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<RecordArguments>();
  CLI::App* command = app.add_subcommand("record", "Record a camera to a folder in TUM layout");
  command->footer(kFooter);
  command->add_option("--source", arguments->source_url, "Frame source; 'camloc doctor' lists what this build knows")->required();
  command->add_option("--out", arguments->out_path, "Folder to write")->required();
  command->add_option("--camera", arguments->camera_path, "Camera file to put beside the frames (default: what the source knows)");
  auto* frames = command->add_option("--frames", arguments->options.max_frames, "Stop after so many frames")->check(CLI::PositiveNumber);
  command->add_option("--seconds", arguments->options.max_seconds, "Stop after so many seconds")
      ->check(CLI::PositiveNumber)
      ->excludes(frames);
  command->add_flag("--color", arguments->format.is_color, "Colour images instead of grey ones, which is what localization uses");
  auto* jpeg = command->add_flag("--jpeg", arguments->format.is_jpeg, "Image as JPEG: a third of the size, not bit-exact");
  command->add_option("--quality", arguments->format.jpeg_quality, "Of the JPEG (default 95)")->check(CLI::Range(1, 100))->needs(jpeg);
  const std::map<std::string, PngCompression> levels{{"fast", PngCompression::kFast}, {"small", PngCompression::kSmall}};
  command
      ->add_option("--compression", arguments->format.compression,
                   "fast (default), or small: depth takes 3 times the time and 3/4 of the bytes")
      ->transform(named_choice(levels));
  command->add_option("--queue", arguments->options.queue_frames, "Frames that may wait for the disk (default 60)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--writers", arguments->options.num_writers, "Threads that encode and write (default 2)")->check(CLI::Range(1, 64));
  command->add_option("--min-free", arguments->min_free_mb, "Stop before less than so many MB are free (default 256)")
      ->check(CLI::Range(1, 100'000'000));
  command->add_option("--timeout", arguments->options.max_silence_s, "Stop when no frame comes for so many seconds (default 10)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--force", arguments->replaces_old, "Replace the recording in an existing folder");
  command->callback([arguments, &exit_code] { exit_code = report(run(*arguments)); });
}

}  // namespace camloc::tools
