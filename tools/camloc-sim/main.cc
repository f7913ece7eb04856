// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-sim: writes a synthetic building to try camloc on. Exit 0 done, 1 failed, 2 usage.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tools/camloc-sim/dataset.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"

namespace {

using camloc::sim::SceneKind;

void add_options(CLI::App* app, std::string* out, camloc::sim::DatasetOptions* options) {
  app->add_option("--out", *out, "Folder to write to; created, must be empty unless --force")->required();
  app->add_option("--scene", options->kind,
                  "building: corridor loop (seed 1: 57 x 40 m) with nine offices; small: a corner and two offices")
      ->transform(
          camloc::tools::named_choice(std::map<std::string, SceneKind>{{"building", SceneKind::kBuilding}, {"small", SceneKind::kSmall}}))
      ->default_str("building");
  app->add_option("--seed", options->seed, "Another seed is another building and another walk")->capture_default_str();
  app->add_option("--rate-hz", options->recording.rate_hz, "Frames per second (default 30; small 10)")->check(CLI::Range(0.1, 240.0));
  app->add_option("--duration-scale", options->recording.duration_scale, "Only this share of each walk")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  app->add_option("--jobs", options->recording.num_jobs, "Threads (default: one per processor); the files do not depend on it")
      ->check(CLI::Range(1, 256));
  app->add_option("--jpeg-quality", options->recording.jpeg_quality, "Colour images; 0 writes PNG")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  app->add_option("--lidar-step", options->lidar_step_m, "Distance between LiDAR points, metres")
      ->check(CLI::Range(0.005, 1.0))
      ->capture_default_str();
  app->add_option("--only", options->only, "Write only this part")->check(CLI::IsMember({"mapping", "day2", "lidar"}));
  app->add_flag("--perfect", options->recording.is_perfect, "No noise, blur or missing depth");
  app->add_flag("--force", options->may_overwrite, "Replace a data set in a folder that is not empty");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Writes a synthetic RGB-D data set: mapping/ and day2/ (TUM layout with ground truth), lidar.ply, camera.toml, "
      "README.txt.\n"
      "Example: camloc sim --scene small --out /tmp/small",
      "camloc-sim");
  std::string out;
  camloc::sim::DatasetOptions options;
  options.recording.rate_hz = 0;
  options.recording.num_jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U));
  add_options(&app, &out, &options);
  bool is_over = false;
  if (const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over); is_over) return usage;
  if (options.recording.rate_hz == 0) options.recording.rate_hz = options.kind == SceneKind::kSmall ? 10 : 30;
  camloc::Result<camloc::sim::DatasetSummary> summary = [&] {
    std::string shown_part;
    std::optional<camloc::tools::ProgressLine> line;
    return camloc::sim::write_dataset(out, options, [&](const std::string& part, int done, int all) {
      if (part != std::exchange(shown_part, part)) line.emplace(static_cast<std::uint64_t>(all), part);
      line->show(static_cast<std::uint64_t>(done));
    });
  }();
  if (!summary) return camloc::tools::report("camloc-sim", summary.status());
  std::printf("%s: mapping %d frames, day2 %d frames, %llu LiDAR points\n", out.c_str(), summary->num_mapping_frames,
              summary->num_day2_frames, camloc::tools::llu(summary->num_lidar_points));
  return 0;
}
