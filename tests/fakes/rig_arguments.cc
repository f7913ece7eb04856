// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/rig_arguments.h"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace camloc::fakes {

void add_rig_options(CLI::App* app, RigArguments* a) {
  app->add_option("--model", a->model, "1414, 1473 or k4w")->check(CLI::IsMember({"1414", "1473", "k4w"}))->capture_default_str();
  app->add_option("--serial", a->rig.kinect.serial, "Serial number of the camera")->capture_default_str();
  app->add_option("--folder", a->rig.replay.folder, "Show this TUM RGB-D or 7-Scenes folder (default: a pattern)");
  app->add_option("--frames", a->rig.replay.frames, "Which of its frames: start:stop:step[,...]");
  app->add_option("--depth-unit-mm", a->rig.replay.depth_unit_mm, "Unit of its depth images: 1 for 7-Scenes, 0.2 for TUM RGB-D")
      ->capture_default_str();
  app->add_option("--cache", a->rig.replay.cache_file, "Keep the rendered frames in this file for the next start");
  app->add_option("--at-end", a->at_end, "After its last frame: loop, or hold it")
      ->check(CLI::IsMember({"loop", "hold"}))
      ->capture_default_str();
  app->add_flag("--wait-for-both", a->rig.kinect.advance_needs_both, "Stay at the first frame until both streams run");
  app->add_option("--geometry", a->geometry,
                  "kinect: depth f=585, colour f=525, 2.5 cm apart; registered: one camera (depth registered to colour, as TUM's)")
      ->check(CLI::IsMember({"kinect", "registered"}))
      ->capture_default_str();
  app->add_option("--clock-ppm", a->clock_ppm, "How much too fast the device's clock is")->capture_default_str();
  app->add_option("--video-delay-ms", a->video_delay_ms, "Exposure of colour after that of depth")->capture_default_str();
  app->add_option("--fault", a->rig.faults, "KIND=PROBABILITY or KIND:TIMES, repeatable (an unknown kind lists them)");
  app->add_option("--seed", a->rig.seed, "Of the faults")->capture_default_str();
  app->add_option("--descriptors", a->descriptors, "none, no-endpoints, truncated, bulk-endpoints, small-packets or empty")
      ->capture_default_str();
  app->add_option("--at", a->timed, "SECONDS:COMMAND, repeatable; a command of the control socket");
  app->add_option("--control", a->control_socket,
                  "UNIX socket for command lines: fault SPEC, stall video|depth|both MS|forever, resume, unplug, replug, counts");
  app->add_option("--log", a->rig.log_file, "A line for each frame sent: stream index stamp_ticks monotonic_ns format damaged xxh3");
  app->add_option("--served", a->rig.served_folder, "Folder that gets each distinct raw frame sent, once");
  app->add_option("--counts", a->counts_file, "File that gets the counts at the end");
}

Status finish(RigArguments* a) {
  a->rig.kinect.model = a->model == "k4w" ? KinectModel::kK4w : a->model == "1473" ? KinectModel::k1473 : KinectModel::k1414;
  if (a->geometry == "registered") a->rig.kinect.calibration = KinectCalibration::registered(a->rig.kinect.calibration.color_focal_px);
  a->rig.replay.at_end = a->at_end == "hold" ? AtEnd::kHold : AtEnd::kLoop;
  if (!(a->rig.replay.depth_unit_mm > 0)) return {ErrorCode::kInvalid, "--depth-unit-mm must be positive"};
  if (!(a->clock_ppm > -1e5 && a->clock_ppm < 1e5)) return {ErrorCode::kInvalid, "--clock-ppm: not between -100000 and 100000"};
  if (!(a->video_delay_ms >= 0 && a->video_delay_ms < 33)) return {ErrorCode::kInvalid, "--video-delay-ms: not in [0, 33)"};
  a->rig.kinect.clock_ppm = a->clock_ppm;
  a->rig.kinect.video_delay_ns = static_cast<std::int64_t>(a->video_delay_ms * 1e6);
  const auto descriptors = parse_bad_descriptors(a->descriptors);
  if (!descriptors) return descriptors.status();
  a->rig.bad_descriptors = *descriptors;
  for (const std::string& text : a->timed) {
    const auto command = parse_timed_command(text);
    if (!command) return command.status();
    a->schedule.push_back(*command);
  }
  return {};
}

Status write_counts(const std::string& path, const std::string& counts) {
  std::FILE* const file = std::fopen(path.c_str(), "we");
  if (file == nullptr) return {ErrorCode::kIo, path + ": " + std::strerror(errno)};
  std::fprintf(file, "%s\n", counts.c_str());
  std::fclose(file);
  return {};
}

}  // namespace camloc::fakes
