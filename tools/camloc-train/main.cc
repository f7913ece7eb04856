// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc train`: from a map and its recordings to a network that says roughly where a camera is.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/coarse/coarse_model.h"
#include "core/io/camera_file.h"
#include "core/map/mapping_guard.h"
#include "drivers/sources.h"
#include "tools/common/command_line.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"
#include "tools/training/device_check.h"
#include "tools/training/held_out.h"
#include "tools/training/labelled_frames.h"
#include "tools/training/learning_curves.h"
#include "tools/training/network_plan.h"
#include "tools/training/trainer.h"

namespace camloc::training {
namespace {

using Json = nlohmann::ordered_json;

struct TrainArguments {
  std::string map_path, camera_path, out_path, init_path;
  std::vector<std::string> sequences, poses;
  std::string frames, exclude, held_out;
  NetworkChoice choice;
  std::string recipe;
  int num_epochs = 0;
  TrainingOptions options;
  bool is_augmented = true, is_resumed = false, is_json = false;

  [[nodiscard]] std::string checkpoint_path() const { return out_path + ".checkpoint"; }
  [[nodiscard]] std::string curves_path() const { return std::filesystem::path(out_path).replace_extension(".png").string(); }
};

/// How many epochs are usually enough, and which recipe is usual.
struct Habit {
  const char* net;
  int num_epochs;
  const char* recipe;
};
constexpr Habit kHabits[] = {{"googlenet", 160, "paper"}, {"resnet", 120, "practical"}, {"squeezenet", 60, "practical"}};
constexpr int kPaperBatchSize = 75;

Status complete(TrainArguments* arguments) {
  for (const Habit& habit : kHabits) {
    if (arguments->choice.net != habit.net) continue;
    if (arguments->recipe.empty()) arguments->recipe = habit.recipe;
    arguments->options.num_epochs = arguments->num_epochs > 0 ? arguments->num_epochs : habit.num_epochs;
  }
  TrainingOptions& options = arguments->options;
  options.recipe = arguments->recipe == "paper" ? Recipe::kPaper : Recipe::kPractical;
  if (options.batch_size == 0) options.batch_size = options.recipe == Recipe::kPaper ? kPaperBatchSize : 16;
  if (!arguments->is_augmented) options.augmentation = {0, 0, 0, 0, 0, 0};
  if (options.is_trunk_frozen && arguments->init_path.empty())
    return {ErrorCode::kInvalid, "--freeze keeps the weights of --init FILE; without them there is nothing to keep"};
  if (!arguments->poses.empty() && arguments->poses.size() != 1 && arguments->poses.size() != arguments->sequences.size())
    return {ErrorCode::kInvalid, "give --poses once for all, or once for each --sequence"};
  std::vector<tools::NamedPath> inputs{{"--map", arguments->map_path}, {"--camera", arguments->camera_path}};
  if (!arguments->init_path.empty()) inputs.push_back({"--init", arguments->init_path});
  return tools::check_outputs(
      {{"--out", arguments->out_path}, {"the learning curves", arguments->curves_path()}, {"the checkpoint", arguments->checkpoint_path()}},
      inputs);
}

/// The network sees the whole image, bar what turning it a little takes.
NetworkInputLayout layout_of(const NetworkPlan& plan, const RgbdCamera& camera) {
  constexpr double kZoom = 1.08;
  const double across = kZoom * camera.color.fx * plan.input.width / camera.color.width;
  const double down = kZoom * camera.color.fy * plan.input.height / camera.color.height;
  return {.channels = plan.input.channels,
          .width = plan.input.width,
          .height = plan.input.height,
          .focal_px = static_cast<float>(std::max(across, down)),
          .mean = plan.mean,
          .scale = plan.scale};
}

struct Lesson {
  TrainingSet set;
  Split split;
  std::uint64_t num_unlabelled = 0;
};

Result<Lesson> prepare(const TrainArguments& arguments, const RgbdCamera& camera, const NetworkInputLayout& layout,
                       WorkObserver* observer) {
  Lesson lesson{TrainingSet(camera, layout, arguments.choice.has_depth), {}, 0};
  for (std::size_t i = 0; i < arguments.sequences.size(); ++i) {
    RecordingRequest request{.map_path = arguments.map_path,
                             .camera_path = arguments.camera_path,
                             .sequence = arguments.sequences[i],
                             .poses = {},
                             .frames = arguments.frames,
                             .exclude = arguments.exclude};
    if (!arguments.poses.empty()) request.poses = arguments.poses[arguments.poses.size() == 1 ? 0 : i];
    const auto counts = add_recording(request, camera, static_cast<std::uint32_t>(i), observer, &lesson.set);
    if (!counts) return counts.status();
    lesson.num_unlabelled += counts->num_unlabelled;
  }
  if (Status status = check_training_views(lesson.set.views()); !status) return status;
  auto split = split_views(lesson.set.views(), arguments.held_out);
  if (!split) return split.status();
  lesson.split = std::move(*split);
  return lesson;
}

CoarseModelInfo info_of(const TrainArguments& arguments, const MapView& map, const RgbdCamera& camera, const NetworkInputLayout& layout,
                        const Lesson& lesson, const HeldOutError& error) {
  CoarseModelInfo info;
  info.map_id = map_id_text(map.info().map_id);
  info.layout = layout;
  info.net = arguments.choice.net;
  for (const std::string& sequence : arguments.sequences) info.training += (info.training.empty() ? "" : ", ") + sequence;
  if (!arguments.frames.empty()) info.training += ", frames " + arguments.frames;
  info.num_training_frames = static_cast<std::uint32_t>(lesson.split.shown.size());
  info.sigma_position_m = std::max(1e-3, error.rms_m / std::sqrt(3.0));
  info.sigma_rotation_rad = std::max(1e-3, error.rms_rad / std::sqrt(3.0));
  info.train_fx = static_cast<float>(camera.color.fx);
  info.train_fy = static_cast<float>(camera.color.fy);
  info.train_width = camera.color.width;
  info.train_height = camera.color.height;
  return info;
}

/// What was written, run as the daemon runs it.
struct DeviceCheck {
  std::optional<double> difference;
  std::string why_not;
};
Result<DeviceCheck> check_device(const TrainArguments& arguments, const RgbdCamera& camera, const Lesson& lesson, Trainer* trainer) {
  constexpr double kMostDifference = 1e-4;
  const auto difference = compare_with_device(arguments.out_path, camera, lesson.set, lesson.split.held_out, trainer);
  if (!difference && difference.status().code() == ErrorCode::kNotFound) return DeviceCheck{std::nullopt, difference.status().message()};
  if (!difference) return difference.status().with_context(arguments.out_path + " is written but does not run");
  if (*difference <= kMostDifference) return DeviceCheck{*difference, ""};
  return {ErrorCode::kCorrupt, arguments.out_path + " is written, but what runs it is " + tools::text_of("%.1g", *difference) +
                                   " off what was trained; please report this with the file"};
}

void print_summary(const TrainArguments& arguments, const Trainer& trainer, const Lesson& lesson, const DeviceCheck& check) {
  const std::size_t best = *trainer.best_epoch();
  const HeldOutError& error = trainer.epochs()[best].held_out;
  double seconds = 0;
  for (const EpochRecord& epoch : trainer.epochs()) seconds += epoch.seconds;
  if (arguments.is_json) {
    const Json json{
        {"out", arguments.out_path},
        {"net", arguments.choice.net},
        {"frames",
         {{"shown", lesson.split.shown.size()}, {"held_out", lesson.split.held_out.size()}, {"without_pose", lesson.num_unlabelled}}},
        {"epochs", trainer.epochs().size()},
        {"best_epoch", best + 1},
        {"seconds", seconds},
        {"device_difference", check.difference ? Json(*check.difference) : Json(nullptr)},
        {"held_out",
         {{"translation_m", {{"median", error.median_m}, {"mean", error.mean_m}, {"rms", error.rms_m}}},
          {"rotation_deg", {{"median", error.median_deg}, {"mean", error.mean_deg}}}}}};
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  std::printf("frames      %zu shown, %zu held out, %llu without a pose\n", lesson.split.shown.size(), lesson.split.held_out.size(),
              tools::llu(lesson.num_unlabelled));
  std::printf("epochs      %zu of %d in %.0f s; the weights of epoch %zu are kept\n", trainer.epochs().size(), arguments.options.num_epochs,
              seconds, best + 1);
  std::printf("held out    median %.2f m %.1f deg, mean %.2f m %.1f deg\n", error.median_m, error.median_deg, error.mean_m, error.mean_deg);
  if (check.difference) {
    std::printf("checked     run as on the device it says the same to %.1g\n", *check.difference);
  } else {
    std::printf("not checked %s\n", check.why_not.c_str());
  }
  std::printf("written     %s, learning curves in %s\n", arguments.out_path.c_str(), arguments.curves_path().c_str());
}

Status begin(const TrainArguments& arguments, Trainer* trainer) {
  if (!arguments.init_path.empty()) {
    const auto model = read_onnx(arguments.init_path);
    if (!model) return model.status();
    if (Status status = trainer->initialize(*model); !status) return status.with_context(arguments.init_path);
  }
  return arguments.is_resumed ? trainer->resume(arguments.checkpoint_path()) : Status::ok();
}

Status write_results(const TrainArguments& arguments, const MapView& map, const RgbdCamera& camera, const NetworkInputLayout& layout,
                     const Lesson& lesson, Trainer* trainer) {
  const HeldOutError& error = trainer->epochs()[*trainer->best_epoch()].held_out;
  OnnxModel model = trainer->best_model();
  set_coarse_info(info_of(arguments, map, camera, layout, lesson, error), &model);
  if (Status status = write_onnx(arguments.out_path, model); !status) return status;
  return write_learning_curves(trainer->epochs(), trainer->best_epoch(), arguments.curves_path());
}

Status train(TrainArguments arguments) {
  if (Status status = complete(&arguments); !status) return status;
  const auto plan = plan_network(arguments.choice);
  if (!plan) return plan.status();
  const auto map = MapView::open(arguments.map_path);
  if (!map) return map.status();
  const auto camera = read_camera_file(arguments.camera_path);
  if (!camera) return camera.status();
  const NetworkInputLayout layout = layout_of(*plan, *camera);

  tools::TerminalObserver observer;
  auto lesson = prepare(arguments, *camera, layout, &observer);
  if (!lesson) return lesson.status();
  Trainer trainer(*plan, lesson->set, lesson->split.shown, lesson->split.held_out, arguments.options);
  if (Status status = begin(arguments, &trainer); !status) return status;
  if (Status status = trainer.run(arguments.checkpoint_path(), &observer); !status) return status;
  observer.show("", 0, 0, "");
  if (!trainer.best_epoch()) return {ErrorCode::kIo, "interrupted before the first epoch was over; nothing was written"};
  if (Status status = write_results(arguments, *map, *camera, layout, *lesson, &trainer); !status) return status;
  const auto check = check_device(arguments, *camera, *lesson, &trainer);
  if (!check) return check.status();
  print_summary(arguments, trainer, *lesson, *check);
  const bool is_whole = static_cast<int>(trainer.epochs().size()) == arguments.options.num_epochs;
  if (!is_whole) {
    std::printf("interrupted after %zu of %d epochs: what was best so far is written; the same command with --resume goes on\n",
                trainer.epochs().size(), arguments.options.num_epochs);
  } else {
    std::error_code ignored;
    std::filesystem::remove(arguments.checkpoint_path(), ignored);
  }
  return Status::ok();
}

void add_options(CLI::App* app, TrainArguments* arguments) {
  app->add_option("--map", arguments->map_path, "Map (.cmap) that the network is for")->required();
  app->add_option("--sequence", arguments->sequences, "Folder or URL of a recording; may be repeated")->required()->allow_extra_args(false);
  app->add_option("--camera", arguments->camera_path, "Camera file of the recordings")->required();
  app->add_option("--out", arguments->out_path,
                  "Model to write (.onnx); learning curves go beside it (.png), checkpoints too (.onnx.checkpoint)")
      ->required();
  app->add_option("--poses", arguments->poses,
                  "Poses in the frame of the map: embedded (of the recording) or a TUM file; default: the map localizes the frames")
      ->allow_extra_args(false);
  app->add_option("--frames", arguments->frames, "Frames to use: start:stop:step[,...], as Python slices (default: all)");
  app->add_option("--exclude", arguments->exclude, "Frames to leave out, same form");
  app->add_option(
      "--held-out", arguments->held_out,
      "Stretch of each recording that is kept back to choose the best weights and to say how far they are off, start:stop[,...] "
      "(default: the last tenth)");
  app->add_option("--net", arguments->choice.net,
                  "resnet: small, 128x96; squeezenet: 224x168, takes weights; googlenet: the PoseNet of 2015, 224x224, takes weights")
      ->check(CLI::IsMember({"googlenet", "resnet", "squeezenet"}))
      ->capture_default_str();
  app->add_flag("--depth", arguments->choice.has_depth, "Depth is a further channel of the image");
  app->add_option("--init", arguments->init_path, "ONNX model whose convolutions the trunk starts from");
  app->add_flag("--freeze", arguments->options.is_trunk_frozen, "Those weights stay; only the head learns");
  app->add_option("--recipe", arguments->recipe,
                  "paper: SGD, 0.001 cut by 90 % every 80 epochs; practical: AdamW (default: what is usual for the network)")
      ->check(CLI::IsMember({"paper", "practical"}));
  app->add_option("--epochs", arguments->num_epochs, "Times that each frame is shown (default: 120 resnet, 60 squeezenet, 160 googlenet)")
      ->check(CLI::Range(1, 100000));
  app->add_option("--batch-size", arguments->options.batch_size, "Frames a step (default: 16; paper: 75)")->check(CLI::Range(1, 4096));
  app->add_option("--learning-rate", arguments->options.learning_rate, "At its highest")
      ->check(CLI::Range(1e-7, 1.0))
      ->capture_default_str();
  app->add_option("--beta", arguments->options.beta, "paper: weight of the rotation beside a metre")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app->add_flag("!--no-augmentation", arguments->is_augmented, "Show the frames as they are: not turned, lit, blurred otherwise");
  app->add_option("--seed", arguments->options.seed, "Of weights, order and augmentation")->capture_default_str();
  app->add_option("--threads", arguments->options.num_threads,
                  "More than one only where nothing else runs: they wait for each other. One makes the same bits every time")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app->add_flag("--resume", arguments->is_resumed, "Go on where an interrupted training stopped");
  app->add_flag("--json", arguments->is_json, "Print the summary as JSON");
  app->footer(
      "Example: ten minutes for a kitchen\n"
      "  camloc train --map kitchen.cmap --sequence recordings/kitchen --camera 7scenes.toml --out coarse.onnx\n"
      "Ctrl-C ends after the batch at hand and writes the best so far. Exit code: 0 done, 1 failed, 2 wrong usage or\n"
      "configuration.");
}

}  // namespace
}  // namespace camloc::training

int main(int argc, char** argv) {
  camloc::install_mapping_guard();
  CLI::App app("Train a network that says roughly where in a map a camera is.", "camloc train");
  app.set_version_flag("--version", "camloc-train " CAMLOC_VERSION);
  camloc::training::TrainArguments arguments;
  arguments.options.batch_size = 0;  // what is usual
  camloc::training::add_options(&app, &arguments);
  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  if (is_over) return usage;
  return camloc::tools::report("camloc-train", camloc::training::train(std::move(arguments)));
}
