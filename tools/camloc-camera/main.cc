// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-camera: finds the calibration of a camera; `camloc camera calibrate` runs this program. A board in front of the camera, or
// recorded, becomes a camera file.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <map>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "core/io/image_writer.h"
#include "drivers/sources.h"
#include "tools/camloc-camera/calibration.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/common/terminal_observer.h"
#include "tools/common/text_format.h"

namespace camloc::camera_tool {
namespace {

constexpr const char* kFooter =
    "Show the board in every part of the image, near and far, tilted 20 to 45 degrees to all sides; hold still now and then. Ctrl-C\n"
    "ends the looking, and what was seen is used. Print the board flat on something stiff, and measure a square with a ruler.\n"
    "Depth that is not registered is placed by the board's plane, which both cameras see; --camera then names a file with the\n"
    "intrinsics of the depth camera.\n"
    "Example: camloc camera calibrate --source kinect:// --board chessboard:9x6:25mm --out camera.toml --png coverage.png\n"
    "Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";

struct Arguments {
  std::string source_url, sequence_path, board_text, camera_path, out_path, png_path;
  CalibrationOptions options;
  double max_seconds = 0;
  bool skips_depth = false;
};

class Display {
 public:
  explicit Display(double max_seconds) : line_(0), max_seconds_(max_seconds), start_(std::chrono::steady_clock::now()) {}

  bool show(const CalibrationViews& views) {
    if (views.views.size() != num_views_) {
      num_views_ = views.views.size();
      grid_ = {views.width, views.height};
      for (const BoardView& view : views.views) grid_.add(view.corners);
    }
    const std::string bare = num_views_ == 0 ? "" : grid_.bare_sides();
    line_.show(views.num_frames, tools::text_of("views %zu  covered %.0f %%%s%s", num_views_, num_views_ == 0 ? 0 : 100 * grid_.covered(),
                                                bare.empty() ? "" : "  show it at ", bare.c_str()));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    return !tools::InterruptGuard::is_interrupted() && (max_seconds_ <= 0 || seconds < max_seconds_);
  }

 private:
  tools::ProgressLine line_;
  double max_seconds_;
  std::chrono::steady_clock::time_point start_;
  std::size_t num_views_ = 0;
  CoverageGrid grid_;
};

Status write_results(const Arguments& arguments, const Calibration& calibration, const CalibrationViews& views) {
  if (Status status = replace_file(arguments.out_path, format_camera_file(calibration, arguments.board_text)); !status) return status;
  if (arguments.png_path.empty()) return Status::ok();
  return write_png(arguments.png_path, draw_coverage(arguments.options.board, calibration, views));
}

Result<CalibrationViews> collect(const Arguments& arguments) {
  auto source = open_frame_source(arguments.sequence_path.empty() ? arguments.source_url : arguments.sequence_path);
  if (!source) return source.status();
  const tools::InterruptGuard guard;
  Display display(arguments.max_seconds);
  return collect_views(source->get(), arguments.options, [&display](const CalibrationViews& views) { return display.show(views); });
}

Status run(Arguments arguments) {
  Result<Board> board = parse_board(arguments.board_text);
  if (!board) return board.status();
  arguments.options.board = *board;
  arguments.options.wants_depth = !arguments.skips_depth;
  if (arguments.source_url.empty() == arguments.sequence_path.empty())
    return {ErrorCode::kInvalid, "give one of --source URL and --sequence DIR"};
  std::vector<tools::NamedPath> outputs{{"--out", arguments.out_path}};
  if (!arguments.png_path.empty()) outputs.push_back({"--png", arguments.png_path});
  Status status = tools::check_outputs(
      outputs, {{"--source", arguments.source_url}, {"--sequence", arguments.sequence_path}, {"--camera", arguments.camera_path}});
  if (!status) return status;
  if (!arguments.camera_path.empty()) {
    const Result<RgbdCamera> known = read_camera_file(arguments.camera_path);
    if (!known) return known.status();
    arguments.options.known = *known;
  }
  const Result<CalibrationViews> views = collect(arguments);
  if (!views) return views.status();
  const Result<Calibration> calibration = calibrate(*views, arguments.options);
  // Arguments were right: what the images do not show is a failure.
  if (!calibration) return {ErrorCode::kUnavailable, calibration.status().message()};
  static_cast<void>(tools::print_text(format_report(*calibration, *views)));
  if (status = write_results(arguments, *calibration, *views); !status) return status;
  std::printf("written     %s\n", arguments.out_path.c_str());
  return Status::ok();
}

void add_calibrate_command(CLI::App* app, Arguments* arguments, int* exit_code) {
  CLI::App* command = app->add_subcommand("calibrate", "Finds intrinsics, distortion and depth errors with a flat board");
  command->footer(kFooter);
  command->add_option("--source", arguments->source_url, "Camera that looks at the board");
  command->add_option("--sequence", arguments->sequence_path, "Recording of the board instead, in TUM or 7-Scenes layout");
  command
      ->add_option("--board", arguments->board_text,
                   "chessboard:9x6:25mm (inner corners) or charuco:7x5:40mm:30mm:DICT_5X5_100 (squares, as OpenCV 4.6 draws them)")
      ->required();
  command->add_option("--out", arguments->out_path, "Camera file to write")->required();
  command->add_option("--png", arguments->png_path, "Picture of the coverage and the errors");
  command->add_option("--camera", arguments->camera_path,
                      "What is known already: depth intrinsics, unit, name (default: what the source knows)");
  const std::map<std::string, LensModel> lenses{
      {"brown_conrady", LensModel::kBrownConrady}, {"equidistant", LensModel::kEquidistant}, {"pinhole", LensModel::kPinhole}};
  command->add_option("--lens", arguments->options.lens, "brown_conrady (default), equidistant for wide angles, pinhole")
      ->transform(camloc::tools::named_choice(lenses));
  command->add_option("--max-views", arguments->options.max_views, "Views to calibrate with (default 40)")->check(CLI::Range(8, 1000));
  command->add_option("--seconds", arguments->max_seconds, "Look for so long (default: to the end of the recording, or Ctrl-C)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--no-depth", arguments->skips_depth, "Leave depth alone");
  command->add_flag("--correct-depth-unit", arguments->options.corrects_depth_unit, "Divide the depth unit by the scale that was measured");
  command->callback([=] { *exit_code = tools::report("camloc-camera", run(*arguments)); });
}

}  // namespace
}  // namespace camloc::camera_tool

int main(int argc, char** argv) {
  CLI::App app{"Finds the calibration of an RGB-D camera.", "camloc-camera"};
  app.require_subcommand(1);
  camloc::camera_tool::Arguments arguments;
  int exit_code = 0;
  camloc::camera_tool::add_calibrate_command(&app, &arguments, &exit_code);
  bool is_over = false;
  const int usage = camloc::tools::parse_command_line(app, argc, argv, &is_over);
  return is_over ? usage : exit_code;
}
