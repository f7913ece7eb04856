// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/build/merge_pipeline.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "core/map/map_writer.h"
#include "tools/common/json_text.h"
#include "tools/common/text_format.h"
#include "tools/mapping/build/map_upgrade.h"

namespace camloc::mapping {
using tools::append_text;
using tools::degrees;

Status interrupted(const std::string& map_path) {
  const bool is_there = std::filesystem::exists(map_path);
  return {ErrorCode::kIo, "interrupted; " + map_path + (is_there ? " is unchanged" : " was not written")};
}

Status merge_into(const std::string& map_a, const MapData& b, const MapMergeOptions& options, const std::string& map_path,
                  WorkObserver& observer, MergeSummary* summary) {
  const auto start = std::chrono::steady_clock::now();
  const auto a = MapView::open(map_a);
  if (!a.is_ok()) return a.status();
  summary->map_a = map_a;
  const auto merged = merge_maps(a.value(), b, options, observer, &summary->report);
  if (!merged.is_ok()) return merged.status().code() == ErrorCode::kUnavailable ? interrupted(map_path) : merged.status();
  if (a.value().is_damaged()) return {ErrorCode::kCorrupt, map_a + ": could not be read to its end; was it changed meanwhile?"};
  // Beside the map, which stays what it was until the new one knows its look-alikes; two merges into one map do not share it.
  const std::string partial_path = map_path + "." + std::to_string(::getpid()) + ".partial";
  Status written = write_map(merged.value(), partial_path);
  if (written.is_ok()) written = upgrade_map(partial_path, map_path, observer);
  std::error_code ignored;
  std::filesystem::remove(partial_path, ignored);
  if (!written.is_ok()) return observer.should_stop() ? interrupted(map_path) : written;
  summary->map_path = map_path;
  summary->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return Status::ok();
}

std::string format_table(const MergeSummary& s) {
  const MapMergeReport& r = s.report;
  const MapBuildReport& m = r.map;
  std::string text;
  append_text(&text, "%-22s%s\n", "merged map", s.map_path.c_str());
  append_text(&text, "%-22s%s: %u landmarks, %u keyframes\n", "first map", s.map_a.c_str(), r.num_landmarks_a, r.num_keyframes_a);
  append_text(&text, "%-22s%s: %u landmarks, %u keyframes\n", "second map", s.map_b.c_str(), r.num_landmarks_b, r.num_keyframes_b);
  append_text(&text, "%-22s%u of %u keyframes of the second map; %u of %u asked by look alone, %u refused\n", "found in the first",
              r.num_localized, r.num_keyframes_b, r.registration.num_convincing, r.registration.num_queries,
              r.registration.num_disagreeing);
  append_text(&text, "%-22s%.1f cm, %.2f deg median of those; the second map was bent by up to %.1f cm\n", "disagreement",
              100 * r.alignment.residual_m, degrees(r.alignment.residual_rad), 100 * r.alignment.deformation_m);
  append_text(&text, "%-22s%u fused, %u added, %u further appearances\n", "landmarks of second", r.num_fused, r.num_added,
              r.num_appearances);
  append_text(&text, "%-22s%u of %u\n", "landmarks kept", m.num_landmarks, m.num_landmarks_before);
  append_text(&text, "%-22s%u, %.2f a landmark\n", "descriptors", m.num_descriptors,
              static_cast<double>(m.num_descriptors) / std::max(1U, m.num_landmarks));
  append_text(&text, "%-22s%u of %u views cover all landmarks\n", "keyframes", m.num_keyframes, m.num_keyframes_before);
  append_text(&text, "%-22s%llu bytes, %.1f a landmark\n", "size", tools::llu(m.file_bytes),
              static_cast<double>(m.file_bytes) / std::max(1U, m.num_landmarks));
  if (r.is_datum_from_b) append_text(&text, "%-22sthat of the second map, carried over\n", "datum");
  append_text(&text, "%-22s%.1f s\n", "time of merging", s.seconds);
  return text;
}

std::string format_json(const MergeSummary& s) {
  const MapMergeReport& r = s.report;
  const Rigid3& T = r.alignment.T_a_b;
  tools::Json json;
  json["map"] = s.map_path;
  json["first"] = {{"map", s.map_a}, {"landmarks", r.num_landmarks_a}, {"keyframes", r.num_keyframes_a}};
  json["second"] = {{"map", s.map_b}, {"landmarks", r.num_landmarks_b}, {"keyframes", r.num_keyframes_b}};
  json["localized_keyframes"] = r.num_localized;
  json["queries"] = {
      {"asked", r.registration.num_queries}, {"convincing", r.registration.num_convincing}, {"refused", r.registration.num_disagreeing}};
  json["T_first_second"] = {{"translation_m", tools::json_of(T.translation)}, {"rotation_wxyz", tools::json_of(T.rotation)}};
  json["disagreement"] = {{"median_m", r.alignment.residual_m},
                          {"median_deg", degrees(r.alignment.residual_rad)},
                          {"deformation_m", r.alignment.deformation_m}};
  json["landmarks"] = {{"fused", r.num_fused},
                       {"added", r.num_added},
                       {"appearances", r.num_appearances},
                       {"before", r.map.num_landmarks_before},
                       {"kept", r.map.num_landmarks}};
  json["descriptors"] = r.map.num_descriptors;
  json["keyframes"] = {{"before", r.map.num_keyframes_before}, {"kept", r.map.num_keyframes}};
  json["words"] = r.map.num_words;
  json["bytes"] = r.map.file_bytes;
  json["is_datum_from_second"] = r.is_datum_from_b;
  json["seconds"] = s.seconds;
  return tools::json_text(json);
}

}  // namespace camloc::mapping
