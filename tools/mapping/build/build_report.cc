// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tools/common/json_text.h"
#include "tools/common/text_format.h"
#include "tools/mapping/build/map_pipeline.h"

namespace camloc::mapping {
namespace {

using tools::append_text;
using tools::degrees;
using tools::Json;
using tools::llu;

double bytes_per_landmark(const BuildSummary& s) {
  return static_cast<double>(s.build.file_bytes) / static_cast<double>(std::max<std::uint32_t>(s.build.num_landmarks, 1));
}

constexpr std::size_t kMaxSpotsShown = 8;
constexpr double kHighCameraM = 3;  // above the floor; people and robots carry theirs below

/// What was left out, and what is hardly true.
std::vector<std::string> all_notes(const BuildSummary& s) {
  std::vector<std::string> notes = s.notes;
  if (!s.slam || !s.slam->up || s.slam->up->source != GravitySource::kFloor || s.slam->up->camera_height_m < kHighCameraM) return notes;
  notes.push_back(tools::text_of(
      "WARNING the floor is %.1f m below the cameras, more than anybody carries one: is unit_m of the camera file right? A map "
      "with a wrong unit agrees with itself and is too large",
      s.slam->up->camera_height_m));
  return notes;
}

std::string vertical_text(const BuildSummary& s) {
  if (s.survey && s.survey->is_written) return "from control points";
  const auto& up = s.slam->up;
  if (!up) return "unknown (" + s.slam->up_problem + "); axes are those of the first camera";
  if (up->source == GravitySource::kFloor) return tools::text_of("from the floor, %.2f m below the cameras; z is up", up->camera_height_m);
  return tools::text_of("from the accelerometer, to %.1f deg; z is up", degrees(up->sigma_rad));
}

void append_slam(const BuildSummary& s, std::string* text) {
  const SlamSummary& slam = *s.slam;
  const SlamCounts& c = slam.counts;
  append_text(text, "%-22s%u of %u, lost %u times\n", "frames tracked", c.num_views - c.num_lost, c.num_views, c.num_losses);
  if (c.num_bridged > 0)
    append_text(text, "%-22s%u, too bare for features: followed by all their pixels\n", "frames bridged", c.num_bridged);
  append_text(text, "%-22s%u, of %u views each on average\n", "SLAM keyframes", c.num_keyframes,
              c.num_views / std::max(c.num_keyframes, 1U));
  append_text(text, "%-22s%u closed, %u refused\n", "loops", c.num_loops, c.num_loops_refused);
  append_text(text, "%-22smedian %.2f px, 90 %% below %.2f px (%llu observations)\n", "reprojection error", slam.fit.median_px,
              slam.fit.p90_px, llu(slam.fit.num_observations));
  append_text(text, "%-22smedian %.1f mm\n", "depth error", 1000 * slam.fit.median_depth_m);
  append_text(text, "%-22s%s\n", "vertical", vertical_text(s).c_str());
}

void append_submaps(const BuildSummary& s, std::string* text) {
  if (s.submaps.empty()) return;
  append_text(text, "%zu further segment%s could not be joined to the map: no place in common was seen with certainty\n", s.submaps.size(),
              s.submaps.size() == 1 ? "" : "s");
  for (const SubmapSummary& submap : s.submaps) {
    append_text(text, "  %-20s%u views, %u keyframes\n", submap.map_path.empty() ? "(too short, left out)" : submap.map_path.c_str(),
                submap.num_views, submap.num_keyframes);
  }
}

// The longest spots, in the order of the recording.
void append_weak_spots(const std::vector<WeakSpot>& all, std::string* text) {
  if (all.empty()) return;
  std::vector<WeakSpot> shown = all;
  const auto length = [](const WeakSpot& w) { return w.last_frame - w.first_frame; };
  std::stable_sort(shown.begin(), shown.end(), [&](const WeakSpot& a, const WeakSpot& b) { return length(a) > length(b); });
  if (shown.size() > kMaxSpotsShown) shown.resize(kMaxSpotsShown);
  std::sort(shown.begin(), shown.end(), [](const WeakSpot& a, const WeakSpot& b) { return a.first_frame < b.first_frame; });
  append_text(text, "weak spots (%zu%s)\n", all.size(), all.size() > shown.size() ? ", the longest shown" : "");
  for (const WeakSpot& w : shown) {
    append_text(text, "  frames %llu to %llu: %s; %s\n", llu(w.first_frame), llu(w.last_frame), w.what.c_str(), w.advice.c_str());
  }
}

Json slam_json(const SlamSummary& slam) {
  const SlamCounts& c = slam.counts;
  Json json{{"views", c.num_views},     {"lost", c.num_lost},           {"losses", c.num_losses},
            {"bridged", c.num_bridged}, {"keyframes", c.num_keyframes}, {"landmarks", c.num_landmarks}};
  json["loops"] = {{"closed", c.num_loops}, {"refused", c.num_loops_refused}};
  json["segments"] = {{"begun", c.num_segments}, {"joined", c.num_joined}};
  json["reprojection_error_px"] = {{"median", slam.fit.median_px}, {"p90", slam.fit.p90_px}};
  json["depth_error_m"] = {{"median", slam.fit.median_depth_m}};
  json["stamp_jumps"] = slam.num_stamp_jumps;
  json["resumed_views"] = slam.num_resumed;
  json["up"] = nullptr;
  if (slam.up)
    json["up"] = {{"source", slam.up->source == GravitySource::kFloor ? "floor" : "accelerometer"},
                  {"sigma_deg", degrees(slam.up->sigma_rad)}};
  json["weak_spots"] = Json::array();
  for (const WeakSpot& w : slam.weak_spots)
    json["weak_spots"].push_back({{"first_frame", w.first_frame}, {"last_frame", w.last_frame}, {"what", w.what}, {"advice", w.advice}});
  return json;
}

}  // namespace

std::string format_table(const BuildSummary& s) {
  const MapBuildReport& b = s.build;
  std::string text;
  append_text(&text, "%-22s%s\n", "map", s.map_path.c_str());
  append_text(&text, "%-22s%u of %llu recorded, %llu selected\n", "frames used", b.num_frames, llu(s.num_recorded), llu(s.num_selected));
  for (const std::string& note : all_notes(s)) append_text(&text, "%-22s%s\n", "note", note.c_str());
  append_text(&text, "%-22s%llu without pose, %llu without depth, %llu broken\n", "frames skipped", llu(s.num_without_pose),
              llu(s.num_without_depth), llu(s.reading.num_corrupt));
  if (s.slam) append_slam(s, &text);
  if (s.pose_verdict && s.pose_verdict->num_motions >= PoseVerdict::kMinMotions) {
    append_text(&text, "%-22s%.1f cm, %.1f deg off between neighbouring frames (%zu pairs that moved by %.1f cm, %.1f deg; medians)\n",
                "given poses", 100 * s.pose_verdict->given.translation_m, degrees(s.pose_verdict->given.rotation_rad),
                s.pose_verdict->num_motions, 100 * s.pose_verdict->moved_m, degrees(s.pose_verdict->turned_rad));
  } else if (s.pose_verdict) {
    append_text(&text, "%-22snot checked against the images: too few neighbouring frames that moved and could be compared\n",
                "given poses");
  }
  if (s.model_scale) append_text(&text, "%-22s%s\n", "scale of the model", describe_scale(*s.model_scale).c_str());
  append_text(&text, "%-22s%llu\n", "observations", llu(b.num_observations));
  append_text(&text, "%-22s%u of %u\n", "landmarks kept", b.num_landmarks, b.num_landmarks_before);
  append_text(&text, "%-22s%u\n", "descriptors", b.num_descriptors);
  append_text(&text, "%-22s%u of %u views cover all landmarks\n", "keyframes", b.num_keyframes, b.num_keyframes_before);
  append_text(&text, "%-22s%u\n", "words", b.num_words);
  append_text(&text, "%-22s%llu bytes, %.1f a landmark\n", "size", llu(b.file_bytes), bytes_per_landmark(s));
  if (s.deformation.sigma_m > 0) {
    append_text(&text, "%-22s%.1f cm, %.2f deg per axis (maps of half of the observations differ by twice that)\n",
                "deformation of the map", 100 * s.deformation.sigma_m, degrees(s.deformation.sigma_rad));
  }
  if (b.num_consistency_pairs > 0) {
    append_text(&text, "%-22s%.1f cm, %.2f deg per axis between views (%u pairs)\n", "pose inconsistency", 100 * s.consistency_sigma_m,
                degrees(s.consistency_sigma_rad), b.num_consistency_pairs);
  } else {
    append_text(&text, "%-22sunknown: no two views see the same place at different times\n", "pose inconsistency");
  }
  append_text(&text, "%-22s%.1f s, %.0f frames/s\n", "time", s.seconds, static_cast<double>(b.num_frames) / std::max(s.seconds, 1e-3));
  if (s.survey) text += "\n" + format_table(*s.survey);
  if (s.merge) text += format_table(*s.merge);
  append_submaps(s, &text);
  if (s.slam) append_weak_spots(s.slam->weak_spots, &text);
  if (s.is_partial) append_text(&text, "interrupted: this is a map of the first part; the same command with --resume goes on\n");
  return text;
}

std::string format_json(const BuildSummary& s) {
  const MapBuildReport& b = s.build;
  Json json{{"map", s.map_path}, {"sequence", s.sequence}, {"camera", s.camera}};
  json["notes"] = all_notes(s);
  json["frames"] = {{"recorded", s.num_recorded},         {"selected", s.num_selected},           {"used", b.num_frames},
                    {"without_pose", s.num_without_pose}, {"without_depth", s.num_without_depth}, {"broken", s.reading.num_corrupt}};
  json["is_partial"] = s.is_partial;
  if (s.slam) json["slam"] = slam_json(*s.slam);
  if (s.model_scale) {
    json["model_scale"] = {{"metres_per_unit", s.model_scale->metres_per_unit},
                           {"spread", s.model_scale->spread},
                           {"image_spread", s.model_scale->image_spread},
                           {"pairs", s.model_scale->num_pairs},
                           {"images", s.model_scale->num_images}};
  }
  if (s.survey) json["survey"] = Json::parse(format_json(*s.survey));
  json["submaps"] = Json::array();
  for (const SubmapSummary& submap : s.submaps)
    json["submaps"].push_back({{"map", submap.map_path}, {"keyframes", submap.num_keyframes}, {"views", submap.num_views}});
  json["observations"] = b.num_observations;
  json["landmarks"] = {{"before", b.num_landmarks_before}, {"kept", b.num_landmarks}};
  json["descriptors"] = b.num_descriptors;
  json["keyframes"] = {{"before", b.num_keyframes_before}, {"kept", b.num_keyframes}};
  json["words"] = b.num_words;
  json["bytes"] = b.file_bytes;
  json["bytes_per_landmark"] = bytes_per_landmark(s);
  json["pose_consistency"] = {
      {"pairs", b.num_consistency_pairs}, {"sigma_m", s.consistency_sigma_m}, {"sigma_deg", degrees(s.consistency_sigma_rad)}};
  json["deformation"] = nullptr;
  if (s.deformation.sigma_m > 0)
    json["deformation"] = {{"sigma_m", s.deformation.sigma_m}, {"sigma_deg", degrees(s.deformation.sigma_rad)}};
  if (s.merge) json["merge"] = Json::parse(format_json(*s.merge), nullptr, false);
  json["seconds"] = s.seconds;
  return tools::json_text(json);
}

}  // namespace camloc::mapping
