// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map export: a map for other programs to look at.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>

#include "core/io/file_bytes.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/named_choice.h"
#include "tools/common/text_format.h"
#include "tools/mapping/colmap/map_export.h"

namespace camloc::mapping {
namespace {

constexpr const char* kFooter =
    "At least one of --ply, --colmap, --tum. The PLY opens in CloudCompare, MeshLab and Open3D, the COLMAP folder with\n"
    "'colmap gui --import_path DIR' (set the minimum track length to 1 there), the trajectory with evo.\n"
    "Example: camloc map export kitchen.cmap --ply kitchen.ply --tum keyframes.txt\n"
    "Exit code: 0 done, 1 failed, 2 wrong usage or configuration.";

struct ExportArguments {
  std::string map_path, ply_path, colmap_folder, tum_path;
  ExportOptions options;
};

Status check_outputs(const ExportArguments& arguments) {
  if (arguments.ply_path.empty() && arguments.colmap_folder.empty() && arguments.tum_path.empty()) {
    return {ErrorCode::kInvalid, "nothing to write; give --ply FILE, --colmap DIR or --tum FILE"};
  }
  std::vector<tools::NamedPath> outputs;
  if (!arguments.ply_path.empty()) outputs.push_back({"--ply", arguments.ply_path});
  if (!arguments.tum_path.empty()) outputs.push_back({"--tum", arguments.tum_path});
  return tools::check_outputs(outputs, {{"the map", arguments.map_path}});
}

Status write_exports(const MapView& map, const ExportArguments& arguments) {
  const ExportOptions& options = arguments.options;
  if (!arguments.ply_path.empty()) {
    if (const Status written = replace_file(arguments.ply_path, format_ply(map, options)); !written.is_ok()) return written;
    std::printf("%s: %llu landmarks\n", arguments.ply_path.c_str(), tools::llu(map.landmarks().size()));
  }
  if (!arguments.colmap_folder.empty()) {
    const ColmapModel model = make_colmap_model(map, options);
    if (const Status written = write_colmap_model(model, arguments.colmap_folder, describe_export(map, options)); !written.is_ok())
      return written;
    std::size_t num_observations = 0;
    for (const ColmapImage& image : model.images) num_observations += image.observations.size();
    std::printf("%s: %llu images, %llu points, %llu observations\n", arguments.colmap_folder.c_str(), tools::llu(model.images.size()),
                tools::llu(model.points.size()), tools::llu(num_observations));
  }
  if (!arguments.tum_path.empty()) {
    if (const Status written = replace_file(arguments.tum_path, format_tum(map, options)); !written.is_ok()) return written;
    std::printf("%s: %llu keyframes\n", arguments.tum_path.c_str(), tools::llu(map.keyframes().size()));
  }
  return std::fflush(stdout) == 0 ? Status::ok() : Status(ErrorCode::kIo, "cannot write to standard output");
}

int run(const ExportArguments& arguments) {
  if (const Status outputs = check_outputs(arguments); !outputs.is_ok()) return report_error(outputs, 2);
  const auto map = MapView::open(arguments.map_path);
  if (!map.is_ok()) return report_error(map.status(), 1);
  if (const Status possible = check_export(map.value(), arguments.options); !possible.is_ok()) return report_error(possible, 2);
  const Status written = write_exports(map.value(), arguments);
  return report(written);
}

}  // namespace

void add_export_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Writes a map as point cloud, COLMAP model or trajectory, for other viewers.");
  command->footer(kFooter);
  command->add_option("MAP", arguments->map_path, "Map file (.cmap)")->required();
  command->add_option("--ply", arguments->ply_path, "Landmarks as a binary PLY point cloud");
  command->add_option("--colmap", arguments->colmap_folder, "Folder for a COLMAP text model: keyframes as images, landmarks as points");
  command->add_option("--tum", arguments->tum_path, "Keyframes as a trajectory in TUM format, one a second");
  command->add_flag("--wcs", arguments->options.use_wcs, "Write coordinates of the site; the map needs a datum");
  const std::map<std::string, PointColoring> colorings{{"height", PointColoring::kHeight}, {"observations", PointColoring::kObservations}};
  command->add_option("--color", arguments->options.coloring, "What the colour of a landmark stands for (default height)")
      ->transform(tools::named_choice(colorings));
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
