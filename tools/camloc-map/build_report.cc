// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-map/build_report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

namespace camloc::map_tool {
namespace {

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

double bytes_per_landmark(const BuildSummary& s) {
  return static_cast<double>(s.build.file_bytes) / static_cast<double>(std::max<std::uint32_t>(s.build.num_landmarks, 1));
}

[[gnu::format(printf, 2, 3)]] void append(std::string* text, const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  *text += line;
}

unsigned long long count(std::uint64_t value) { return value; }

}  // namespace

std::string format_table(const BuildSummary& s) {
  const MapBuildReport& b = s.build;
  std::string text;
  append(&text, "%-22s%s\n", "map", s.map_path.c_str());
  append(&text, "%-22s%u of %llu recorded, %llu selected\n", "frames used", b.num_frames, count(s.num_recorded),
         count(s.num_selected));
  append(&text, "%-22s%llu without pose, %llu without depth, %llu broken\n", "frames skipped", count(s.num_without_pose),
         count(s.num_without_depth), count(s.num_broken));
  append(&text, "%-22s%llu\n", "observations", count(b.num_observations));
  append(&text, "%-22s%u of %u\n", "landmarks kept", b.num_landmarks, b.num_landmarks_before);
  append(&text, "%-22s%u\n", "descriptors", b.num_descriptors);
  append(&text, "%-22s%u of %u views cover all landmarks\n", "keyframes", b.num_keyframes, b.num_keyframes_before);
  append(&text, "%-22s%u\n", "words", b.num_words);
  append(&text, "%-22s%llu bytes, %.1f a landmark\n", "size", count(b.file_bytes), bytes_per_landmark(s));
  if (b.num_consistency_pairs > 0) {
    append(&text, "%-22s%.1f cm, %.2f deg per axis between views (%u pairs)\n", "pose inconsistency", 100 * s.pose_sigma_m,
           degrees(s.pose_sigma_rad), b.num_consistency_pairs);
  } else {
    append(&text, "%-22sunknown: no two views see the same place at different times\n", "pose inconsistency");
  }
  append(&text, "%-22s%.1f s\n", "time", s.seconds);
  return text;
}

std::string format_json(const BuildSummary& s) {
  const MapBuildReport& b = s.build;
  nlohmann::ordered_json json;
  json["map"] = s.map_path;
  json["sequence"] = s.sequence;
  json["camera"] = s.camera;
  json["frames"] = {{"recorded", s.num_recorded},         {"selected", s.num_selected},           {"used", b.num_frames},
                    {"without_pose", s.num_without_pose}, {"without_depth", s.num_without_depth}, {"broken", s.num_broken}};
  json["observations"] = b.num_observations;
  json["landmarks"] = {{"before", b.num_landmarks_before}, {"kept", b.num_landmarks}};
  json["descriptors"] = b.num_descriptors;
  json["keyframes"] = {{"before", b.num_keyframes_before}, {"kept", b.num_keyframes}};
  json["words"] = b.num_words;
  json["bytes"] = b.file_bytes;
  json["bytes_per_landmark"] = bytes_per_landmark(s);
  json["pose_consistency"] = {
      {"pairs", b.num_consistency_pairs}, {"sigma_m", s.pose_sigma_m}, {"sigma_deg", degrees(s.pose_sigma_rad)}};
  json["seconds"] = s.seconds;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace camloc::map_tool
