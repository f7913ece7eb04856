// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc bench`: time of every stage and accuracy, side by side with plain OpenCV calls on the same frames in one run.
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <span>

#include "core/map/mapping_guard.h"
#include "drivers/source_url.h"
#include "tools/camloc-bench/commands.h"
#include "tools/camloc-bench/opencv_reference.h"
#include "tools/common/command_line.h"
#include "tools/common/text_format.h"
#include "tools/evaluation/sequence_run.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::bench {
namespace {

using tools::EstimatedTrajectory;
using tools::llu;
using tools::TrajectoryErrors;
using Json = nlohmann::ordered_json;

struct BenchArguments {
  tools::SequenceRunOptions run;
  std::string mode = "track";
  std::string clock = "wall";
  bool has_reference = false;
  bool is_json = false;
  int repeat = 1;
};

std::int64_t thread_cpu_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

/// Milliseconds of one stage over all frames.
struct Samples {
  std::string name;
  std::vector<double> ms;

  [[nodiscard]] double percentile(double fraction) const {
    if (ms.empty()) return 0;
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(std::lround(fraction * static_cast<double>(sorted.size() - 1)))];
  }
};

/// One contestant: its stages (the last is the total) and its trajectory.
struct Contestant {
  std::string name;
  std::vector<Samples> stages;
  EstimatedTrajectory trajectory;
  std::optional<TrajectoryErrors> errors;

  Contestant(const char* contestant, std::initializer_list<const char*> stage_names) : name(contestant) {
    for (const char* stage : stage_names) stages.push_back({stage, {}});
  }
  void add_times(std::span<const std::int64_t> stage_ns) {
    for (std::size_t i = 0; i < stages.size(); ++i) stages[i].ms.push_back(1e-6 * static_cast<double>(stage_ns[i]));
  }
};

/// Poses recorded with the sequence, as the colour camera's; empty where there are none.
std::vector<StampedPose> recorded_poses(const BenchArguments& arguments, const RgbdCamera& camera) {
  const auto url = parse_source_url(arguments.run.sequence_url);
  if (!url || url->scheme != "replay") return {};
  auto recorded = tools::read_recorded_poses(url->path, "", tools::depth_camera_offset(camera));
  return recorded ? std::move(recorded->poses) : std::vector<StampedPose>();
}

/// Median over the frames of reference time / our time: robust when the machine's speed drifts during the run.
double median_ratio(const Contestant& ours, const Contestant& reference) {
  Samples ratios{"ratio", {}};
  const auto& a = ours.stages.back().ms;
  const auto& b = reference.stages.back().ms;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.ms.push_back(b[i] / std::max(1e-6, a[i]));
  return ratios.percentile(0.5);
}

void print_table(const std::vector<Contestant>& contestants, std::uint64_t num_frames, const BenchArguments& arguments) {
  std::printf("%llu frames, mode %s, %s time, milliseconds\n", llu(num_frames), arguments.mode.c_str(), arguments.clock.c_str());
  for (const Contestant& contestant : contestants) {
    std::printf("\n%-22s %8s %8s %8s\n", contestant.name.c_str(), "p50", "p95", "p99");
    for (const Samples& stage : contestant.stages) {
      std::printf("  %-20s %8.3f %8.3f %8.3f\n", stage.name.c_str(), stage.percentile(0.5), stage.percentile(0.95), stage.percentile(0.99));
    }
    std::printf("  poses %zu", contestant.trajectory.poses.size());
    if (contestant.errors) {
      const TrajectoryErrors& e = *contestant.errors;
      std::printf(", median %.2f cm / %.2f deg, p90 %.2f cm, within 5cm/5deg %.1f %%, misleading %llu", 100 * e.translation_m.median,
                  e.rotation_deg.median, 100 * e.translation_m.p90, 100 * e.share_within[1], llu(e.num_misleading));
    }
    std::printf("\n");
  }
  if (contestants.size() == 2)
    std::printf("\nper frame, the reference takes %.1f times as long (median)\n", median_ratio(contestants[0], contestants[1]));
}

void print_json(const std::vector<Contestant>& contestants, std::uint64_t num_frames, const BenchArguments& arguments) {
  Json json{{"frames", num_frames}, {"mode", arguments.mode}, {"clock", arguments.clock}};
  for (const Contestant& contestant : contestants) {
    Json stages;
    for (const Samples& stage : contestant.stages)
      stages[stage.name] = {{"p50", stage.percentile(0.5)}, {"p95", stage.percentile(0.95)}, {"p99", stage.percentile(0.99)}};
    Json entry{{"stages_ms", stages}, {"poses", contestant.trajectory.poses.size()}};
    if (contestant.errors) {
      const TrajectoryErrors& e = *contestant.errors;
      entry["translation_m"] = {
          {"median", e.translation_m.median}, {"mean", e.translation_m.mean}, {"p90", e.translation_m.p90}, {"max", e.translation_m.max}};
      entry["rotation_deg"] = {{"median", e.rotation_deg.median}, {"p90", e.rotation_deg.p90}};
      entry["within_5cm_5deg"] = e.share_within[1];
      entry["within_10cm_10deg"] = e.share_within[2];
      entry["misleading"] = e.num_misleading;
    }
    json[contestant.name] = entry;
  }
  if (contestants.size() == 2) json["reference_time_ratio"] = median_ratio(contestants[0], contestants[1]);
  std::printf("%s\n", json.dump(1).c_str());
}

Status bench(const BenchArguments& arguments) {
  const StageTimer::Clock clock = arguments.clock == "cpu" ? thread_cpu_ns : tools::monotonic_ns;
  std::vector<Contestant> contestants;
  contestants.push_back({"camloc", {"extract", "candidates", "match", "estimate", "verify", "total"}});
  if (arguments.has_reference) contestants.push_back({"opencv", {"extract (cv::ORB)", "match (BFMatcher)", "estimate (PnP)", "total"}});

  tools::SequenceRunOptions run_options = arguments.run;
  run_options.clock = clock;
  std::uint64_t num_frames = 0;
  std::vector<StampedPose> truth;
  for (int pass = 0; pass < arguments.repeat; ++pass) {
    auto run = tools::open_sequence_run(run_options);
    if (!run) return run.status();
    Localizer& localizer = *run->localizer;
    OpencvReference reference(*run->map, run->camera, !arguments.run.is_single, clock);
    const auto counts = tools::read_perturbed_frames(*run, [&](const Frame& frame) {
      const Localization ours = localizer.process(frame);
      contestants[0].add_times(ours.stage_ns);
      if (ours.state == State::kLocalized) contestants[0].trajectory.poses.push_back({ours.stamp_ns, ours.T_map_camera, ours.covariance});
      if (!arguments.has_reference) return;
      const ReferenceResult theirs = reference.process(frame);
      contestants[1].add_times(theirs.stage_ns);
      if (theirs.T_map_camera) contestants[1].trajectory.poses.push_back({frame.stamp_ns, *theirs.T_map_camera, std::nullopt});
    });
    if (!counts) return counts.status();
    if (pass == 0) tools::warn_of_corrupt_frames("camloc bench", *counts);
    num_frames += counts->num_frames;
    if (pass == 0) truth = recorded_poses(arguments, run->camera);
  }
  if (!truth.empty()) {
    for (Contestant& contestant : contestants) {
      contestant.errors = tools::compare(
          contestant.trajectory, [&](std::int64_t stamp_ns) { return pose_at(truth, stamp_ns); }, num_frames);
    }
  }
  if (arguments.is_json)
    print_json(contestants, num_frames, arguments);
  else
    print_table(contestants, num_frames, arguments);
  return Status::ok();
}

}  // namespace
}  // namespace camloc::bench

int main(int argc, char** argv) {
  camloc::install_mapping_guard();
  cv::setNumThreads(1);
  camloc::bench::BenchArguments arguments;
  CLI::App app("Time and accuracy of localization, stage by stage", "camloc bench");
  app.add_option("--map", arguments.run.map_path, "Map (.cmap)")->required();
  app.add_option("--sequence", arguments.run.sequence_url, "Folder or URL of the recording")->required();
  app.add_option("--camera", arguments.run.camera_path, "Camera file")->required();
  app.add_option("--set", arguments.run.numbers, "For experiments: localizer.NAME=VALUE; an unknown NAME lists them all");
  app.add_option("--frames", arguments.run.frames, "Frames to use: start:stop:step[,...]");
  app.add_option("--mode", arguments.mode, "track: frames follow each other; single: every frame on its own")
      ->check(CLI::IsMember({"track", "single"}))
      ->capture_default_str();
  app.add_option("--clock", arguments.clock, "wall, or cpu: time of this thread only, steadier on a busy machine")
      ->check(CLI::IsMember({"wall", "cpu"}))
      ->capture_default_str();
  app.add_option("--repeat", arguments.repeat, "Passes over the sequence")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_flag("--reference-opencv", arguments.has_reference, "Also run cv::ORB + cv::BFMatcher + cv::solvePnPRansac on the same frames");
  app.add_flag("--json", arguments.is_json, "Print JSON");
  app.footer(
      "Example: camloc bench --map kitchen.cmap --sequence recordings/kitchen --camera 7scenes.toml --frames 300:600:5 \\\n"
      "             --mode single --reference-opencv\n"
      "Exit code: 0 done, 1 failed, 2 wrong usage or configuration.");
  int exit_code = 0;
  CLI::App* slam = camloc::bench::add_slam_command(app, exit_code);
  // What localizing needs is not asked for with another command.
  slam->preparse_callback([&app](std::size_t) {
    for (CLI::Option* option : app.get_options()) option->required(false);
  });
  bool is_over = false;
  if (const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over); is_over) return usage;
  if (slam->parsed()) return exit_code;
  arguments.run.is_single = arguments.mode == "single";
  return camloc::tools::report("camloc", camloc::bench::bench(arguments));
}
