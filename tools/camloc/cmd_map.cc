// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc map info` and `camloc map verify`: what is in a map file, and whether it is whole.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/geometry/wcs.h"
#include "core/map/map_view.h"
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"
#include "tools/common/json_text.h"
#include "tools/common/text_format.h"
#include "tools/evaluation/sequence_run.h"

namespace camloc::tools {
namespace {

struct MapArguments {
  std::string path;
  bool is_json = false;
};

double bytes_per_landmark(const MapInfo& info) {
  return info.num_landmarks == 0 ? 0.0 : static_cast<double>(info.file_bytes) / info.num_landmarks;
}

/// The middle of the keyframes: at the origin of `map`, which may be far from the building, a turn of the datum weighs more.
PoseWithCovariance middle_in_wcs(const MapView& map) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::uint32_t k = 0; k < map.info().num_keyframes; ++k) sum += map.keyframe_pose(k).translation;
  PoseWithCovariance middle;
  middle.pose.translation = sum / std::max<double>(1.0, map.info().num_keyframes);
  return to_wcs(*map.info().wcs, middle);
}

double position_sigma_m(const Matrix6d& covariance) { return std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3); }
double turn_sigma_deg(const Matrix6d& covariance) { return degrees(std::sqrt(covariance.bottomRightCorner<3, 3>().trace() / 3)); }

Json datum_json(const MapView& map) {
  if (!map.info().wcs) return nullptr;
  const Rigid3& T = map.info().wcs->T_wcs_map;
  const PoseWithCovariance middle = middle_in_wcs(map);
  return {{"position_m", json_of(T.translation)},
          {"orientation_wxyz", json_of(T.rotation)},
          {"middle_m", json_of(middle.pose.translation)},
          {"sigma_m", position_sigma_m(middle.covariance)},
          {"sigma_deg", turn_sigma_deg(middle.covariance)}};
}

void print_datum(const MapView& map) {
  if (!map.info().wcs) {
    std::printf("world frame  not set: poses are in the map's own frame; set it with 'camloc map georef'\n");
    return;
  }
  const PoseWithCovariance middle = middle_in_wcs(map);
  const Eigen::Vector3d& p = middle.pose.translation;
  std::printf("world frame  set: the middle of the map is at %.3f %.3f %.3f in the site, +- %.3f m and %.3f deg per axis\n", p.x(), p.y(),
              p.z(), position_sigma_m(middle.covariance), turn_sigma_deg(middle.covariance));
}

bool is_optional(const MapSection& section) { return (section.record.flags & map_format::kSectionIsOptional) != 0; }

Json sections_json(const MapView& map) {
  Json sections = Json::array();
  for (const MapSection& section : map.sections()) {
    sections.push_back({{"name", section.name},
                        {"known", section.kind != nullptr},
                        {"optional", is_optional(section)},
                        {"elements", section.record.num_elements},
                        {"bytes", section.bytes.size()}});
  }
  return sections;
}

void print_json(const MapView& map, double open_ms) {
  const MapInfo& info = map.info();
  const Json json{{"path", info.path},
                  {"name", info.name},
                  {"map_id", text_of("%016llx", llu(info.map_id))},
                  {"version", info.version},
                  {"bytes", info.file_bytes},
                  {"bytes_per_landmark", bytes_per_landmark(info)},
                  {"landmarks", info.num_landmarks},
                  {"descriptors", info.num_descriptors},
                  {"keyframes", info.num_keyframes},
                  {"words", info.num_words},
                  {"cubes", info.num_cubes},
                  {"pose_sigma_m", info.pose_sigma_m},
                  {"pose_sigma_deg", degrees(info.pose_sigma_rad)},
                  {"camera", info.camera.name},
                  {"georeferenced", info.wcs.has_value()},
                  {"T_wcs_map", datum_json(map)},
                  {"sections", sections_json(map)},
                  {"open_ms", open_ms}};
  static_cast<void>(print_text(json_text(json, 1)));
}

/// What is in the map and nobody here can use.
void print_skipped(const MapView& map) {
  for (const MapSection& section : map.sections()) {
    if (section.kind == nullptr)
      std::printf("skipped      section %s, %zu bytes: optional, made by a newer camloc\n", printable(section.name).c_str(),
                  section.bytes.size());
  }
}

void print_table(const MapView& map, double open_ms) {
  const MapInfo& info = map.info();
  std::printf("map          %s%s%s\n", info.path.c_str(), info.name.empty() ? "" : ", ", printable(info.name).c_str());
  std::printf("id           %016llx, format version %u\n", llu(info.map_id), info.version);
  std::printf("size         %.3f MB, %.1f bytes a landmark, opened in %.2f ms\n", 1e-6 * static_cast<double>(info.file_bytes),
              bytes_per_landmark(info), open_ms);
  std::printf("landmarks    %u with %u descriptors in %u cubes of coordinates\n", info.num_landmarks, info.num_descriptors, info.num_cubes);
  std::printf("keyframes    %u (the minimum set that covers all landmarks), %u words\n", info.num_keyframes, info.num_words);
  if (info.pose_sigma_m > 0) {
    std::printf("mapping      poses of the mapping are good to %.1f cm and %.2f deg per axis; none that is found in the map is better\n",
                100.0 * info.pose_sigma_m, degrees(info.pose_sigma_rad));
  } else {
    std::printf("mapping      how good the poses of the mapping are is not known: too few views of the same place\n");
  }
  if (map.section(map_format::kTwins).empty())
    std::printf("look-alikes  not known: camloc map upgrade %s\n", info.path.c_str());
  else
    std::printf("look-alikes  %zu places that another one could be taken for\n",
                map.section(map_format::kRivals).size() / sizeof(map_format::RivalRecord));
  std::printf("camera       %s\n", printable(info.camera.name).c_str());
  print_datum(map);
  print_skipped(map);
}

Status show_info(const MapArguments& arguments) {
  const std::int64_t started_ns = monotonic_ns();
  auto map = MapView::open(arguments.path);
  if (!map) return map.status();
  const double open_ms = 1e-6 * static_cast<double>(monotonic_ns() - started_ns);
  if (arguments.is_json)
    print_json(*map, open_ms);
  else
    print_table(*map, open_ms);
  return Status::ok();
}

Status verify_map(const MapArguments& arguments) {
  // Opening checks everything: sizes, checksums, every index and range.
  auto map = MapView::open(arguments.path);
  if (!map) return map.status();
  std::printf("%s: whole: %u landmarks, %u keyframes, all checksums and indices right\n", arguments.path.c_str(), map->info().num_landmarks,
              map->info().num_keyframes);
  print_skipped(*map);
  return Status::ok();
}

}  // namespace

void add_map_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = app.add_subcommand("map", "Look at a map; build one with the program camloc-map");
  command->require_subcommand(1);
  CLI::App* info = command->add_subcommand("info", "What is in a map");
  info->add_option("MAP", arguments->path, "Map file (.cmap)")->required();
  info->add_flag("--json", arguments->is_json, "Print JSON");
  info->callback([arguments, &exit_code] { exit_code = report(show_info(*arguments)); });
  CLI::App* verify = command->add_subcommand("verify", "Check every byte and index of a map; exit code 0 when whole");
  verify->add_option("MAP", arguments->path, "Map file (.cmap)")->required();
  verify->callback([arguments, &exit_code] { exit_code = report(verify_map(*arguments)); });
}

}  // namespace camloc::tools
