// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camloc-map georef: where the map lies in the site, from surveyed control points.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <set>

#include "core/geometry/gravity.h"
#include "core/io/camera_file.h"
#include "core/map/map_unpack.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/map_points.h"
#include "tools/common/terminal_observer.h"
#include "tools/mapping/site/control_points.h"
#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {
namespace {

constexpr const char* kFooter =
    "Points file, coordinates of the site in metres:   name x y z [sigma_m]        (sigma 0.01 when not given)\n"
    "Observed file, any number of lines for a name:    name map x y z [sigma_m]    picked in an export of the map\n"
    "                                                  name landmark INDEX         a landmark of the map\n"
    "                                                  name pixel FRAME u v        a pixel of a frame of --sequence\n"
    "Fields are separated by blanks, commas, semicolons or tabs; '#' starts a comment.\n"
    "Example: see whether the points fit, then write the datum into the map\n"
    "  camloc-map georef office.cmap --points site.csv --observed seen.txt --sequence recordings/office \\\n"
    "      --camera kinect.toml --dry-run\n"
    "Exit code: 0 done, 1 the points do not fit or failed, 2 wrong usage or files that cannot be read as said.";

/// A landmark's scatter is of its observations; its mean is better, but not better than this.
constexpr double kMinLandmarkSigmaM = 0.003;

struct GeorefArguments {
  GeorefSummary summary;  ///< with the paths of the files
  std::string sequence_url, camera_path;
  GeorefOptions fit;
  bool is_dry_run = false, is_json = false;
};

Result<PointMeasurement> landmark_measurement(const MapView& map, std::uint32_t landmark) {
  if (landmark >= map.info().num_landmarks) {
    return {ErrorCode::kNotFound, "the map has landmarks 0 to " + std::to_string(map.info().num_landmarks - 1)};
  }
  const double sigma_m = std::max(kMinLandmarkSigmaM, 0.001 * map.landmarks()[landmark].position_sigma_mm);
  return PointMeasurement{.name = {}, .p_map = map.position_m(landmark).cast<double>(), .sigma_m = sigma_m, .source = {}};
}

bool has_pixels(const std::vector<ControlObservation>& observations) {
  return std::any_of(observations.begin(), observations.end(), [](const auto& o) { return o.kind == ObservationKind::kPixel; });
}

Status check_arguments(const GeorefArguments& arguments, const std::vector<ControlObservation>& observations) {
  if (!has_pixels(observations) || (!arguments.sequence_url.empty() && !arguments.camera_path.empty())) return Status::ok();
  return {ErrorCode::kInvalid, arguments.summary.observed_path +
                                   ": has pixels of recorded frames; name the recording with --sequence and its camera "
                                   "file with --camera"};
}

/// Everything that the observed file names, as points of the map.
Result<ResolvedObservations> resolve(const GeorefArguments& arguments, const MapView& map,
                                     const std::vector<ControlObservation>& observations) {
  RgbdCamera camera = map.info().camera;
  std::map<std::uint64_t, LocalizedFrame> frames;
  if (has_pixels(observations)) {
    const Result<RgbdCamera> read = read_camera_file(arguments.camera_path);
    if (!read) return read.status();
    camera = *read;
    const tools::TerminalObserver observer;
    auto localized = localize_frames(map, camera, arguments.sequence_url, observations, observer);
    if (!localized) return localized.status();
    frames = std::move(localized).value();
  }
  ControlSources sources;
  sources.landmark = [&](std::uint32_t landmark) { return landmark_measurement(map, landmark); };
  sources.T_map_camera = [&](std::uint64_t frame) { return frames.at(frame).T_map_camera; };
  sources.pixel = [&](const ControlObservation& pixel) { return frames.at(pixel.frame).measurements.at(pixel.line); };
  return resolve_observations(observations, camera, sources);
}

void name_partnerless(const std::vector<ControlPoint>& points, const std::vector<ControlObservation>& observations,
                      GeorefSummary* summary) {
  std::set<std::string> surveyed, observed;
  for (const ControlPoint& point : points) surveyed.insert(point.name);
  for (const ControlObservation& observation : observations) {
    if (observed.insert(observation.name).second && !surveyed.contains(observation.name))
      summary->only_in_observed.push_back(observation.name);
  }
  for (const ControlPoint& point : points) {
    if (!observed.contains(point.name)) summary->only_in_points.push_back(point.name);
  }
}

Status write_datum(const MapView& map, const WcsDatum& datum, const std::string& path) {
  MapData data = unpack_map(map);
  data.wcs = datum;
  const MapWriteOptions options = write_options_of(map);
  if (map.is_damaged()) return {ErrorCode::kCorrupt, map.info().path + ": was changed while it was read; try again"};
  return write_map(data, path, options);
}

Status georef(const GeorefArguments& arguments, GeorefSummary* summary) {
  const auto points = read_control_points(summary->points_path);
  if (!points) return points.status();
  const auto observations = read_control_observations(summary->observed_path);
  if (!observations) return observations.status();
  if (const Status status = check_arguments(arguments, *observations); !status) return status;
  const auto map = MapView::open(summary->map_path);
  if (!map) return map.status();
  const auto resolved = resolve(arguments, *map, *observations);
  if (!resolved) return resolved.status();

  summary->left_out = resolved->left_out;
  summary->has_replaced_datum = map->info().wcs.has_value();
  name_partnerless(*points, *observations, summary);
  const std::vector<ObservedPoint> observed = average_measurements(resolved->measurements);
  GeorefOptions options = arguments.fit;
  // From the keyframes alone: a datum that is already there may be the wrong one.
  options.up_map = rough_up(tools::keyframe_poses(*map));
  summary->fit = fit_georef(match_points(*points, observed), options);
  for (const ObservedPoint& point : observed) {
    if (point.farthest.empty()) continue;
    summary->fit.warnings.push_back("the measurements of " + point.name + " scatter more than their accuracy explains; the farthest is " +
                                    point.farthest + ": is it another point?");
  }
  if (!summary->fit.problem.empty() || arguments.is_dry_run) return Status::ok();
  if (const Status status = write_datum(*map, summary->fit.datum, summary->out_path); !status) return status;
  summary->is_written = true;
  return Status::ok();
}

int run(const GeorefArguments& arguments) {
  GeorefSummary summary = arguments.summary;
  if (summary.out_path.empty()) summary.out_path = summary.map_path;
  // --out may be the map, which is in the new one.
  const std::vector<tools::NamedPath> inputs{{"--points", summary.points_path}, {"--observed", summary.observed_path}};
  if (const Status output = tools::check_outputs({{"--out", summary.out_path}}, inputs); !output) return report_error(output, 2);
  if (const Status status = georef(arguments, &summary); !status) { return report(status); }
  const std::string text = arguments.is_json ? format_json(summary) : format_table(summary);
  const bool is_printed = tools::print_text(text);
  if (!summary.fit.problem.empty()) {
    return report_error({ErrorCode::kInvalid, summary.points_path + ": " + summary.fit.problem + "; no datum was written"}, 1);
  }
  return is_printed ? 0 : 1;
}

}  // namespace

void add_georef_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<GeorefArguments>();
  CLI::App* command = app.add_subcommand("georef", "Fits a map into site coordinates by control points and writes the datum into it.");
  command->footer(kFooter);
  command->add_option("MAP", arguments->summary.map_path, "Map file (.cmap)")->required();
  command->add_option("--points", arguments->summary.points_path, "Surveyed control points")->required();
  command->add_option("--observed", arguments->summary.observed_path, "Where the map, or frames of a recording, show them")->required();
  command->add_option("--sequence", arguments->sequence_url, "Recording that observed pixels belong to: replay://DIR or a folder");
  command->add_option("--camera", arguments->camera_path, "Calibration of that recording's camera");
  command->add_option("--out", arguments->summary.out_path, "Map to write (default: MAP itself, replaced as a whole)");
  command->add_option("--tolerance", arguments->fit.tolerance_m, "A point that is off by less is no suspect, metres")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  command->add_flag("--exclude-suspects", arguments->fit.is_excluding_suspects, "Fit without the points that contradict the others");
  command->add_flag("--dry-run", arguments->is_dry_run, "Only print; write nothing");
  command->add_flag("--json", arguments->is_json, "Print JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace camloc::mapping
