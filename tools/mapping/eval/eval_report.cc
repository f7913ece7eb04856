// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/json_text.h"
#include "tools/common/text_format.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

using tools::append_text;
using tools::degrees;
using tools::Json;
using tools::json_of;
using tools::llu;

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

std::vector<std::string> all_warnings(const EvalSummary& s) {
  std::vector<std::string> warnings = s.cloud_warnings;
  const std::vector<std::string> more = warnings_of(s.evaluation);
  warnings.insert(warnings.end(), more.begin(), more.end());
  return warnings;
}

void append_inputs(const EvalSummary& s, std::string* text) {
  const Evaluation& e = s.evaluation;
  append_text(text, "%-22s%s\n", "map", s.map_path.c_str());
  append_text(text, "%-22s%llu of %llu with at least %u observations, %llu keyframes\n", "landmarks", llu(e.num_used), llu(e.num_landmarks),
              s.min_observations, llu(e.num_keyframes));
  append_text(text, "%-22s%s\n", "cloud", s.cloud_name.c_str());
  append_text(text, "%-22s%llu read, %llu of them invalid, %llu kept (voxel %.3g m)\n", "points", llu(s.num_read), llu(s.num_invalid),
              llu(s.num_points), s.voxel_m);
  if (!s.unit_from.empty()) append_text(text, "%-22s%.10g m (%s)\n", "unit", s.unit_m, s.unit_from.c_str());
  for (const std::string& note : s.cloud_notes) append_text(text, "%-22s%s\n", "note", note.c_str());
}

void append_alignment(const EvalSummary& s, std::string* text) {
  const Evaluation& e = s.evaluation;
  append_text(text, "%-22s%s", "start", describe(e.start));
  if (e.search)
    append_text(text, ": %s, landmarks %.1f cm off (next best place %.1f cm)",
                e.search->is_identity ? "the map's own frame" : "walls on walls", 100 * e.search->score_m, 100 * e.search->rival_score_m);
  append_text(text, "\n");
  if (e.registration) {
    const Registration& r = *e.registration;
    append_text(text, "%-22smoved by %.3f m, %.2f deg in %d iterations%s; %llu of %llu landmarks used, %.1f mm RMS to the surface\n", "ICP",
                e.moved_m, degrees(e.moved_rad), r.num_iterations, r.is_converged ? "" : " (not converged)", llu(r.num_correspondences),
                llu(r.num_points), 1000 * r.rms_m);
  } else {
    append_text(text, "%-22snone\n", "ICP");
  }
}

void append_points(const Evaluation& e, std::string* text) {
  if (e.residuals.empty()) return;
  append_text(text, "\n%-22s%10s%10s\n", "control point", "fit [cm]", "ICP [cm]");
  for (const PointResidual& r : e.residuals)
    append_text(text, "  %-20s%10.1f%10.1f\n", r.name.substr(0, 20).c_str(), 100 * r.aligned_m.norm(), 100 * r.final_m.norm());
}

void append_row(const char* name, const DistanceStatistics& d, std::string* text) {
  append_text(text, "  %-26s%9llu%8.2f%8.2f%8.2f%8.2f%8.1f%8.1f\n", name, llu(d.count), 100 * d.mean_m, 100 * d.median_m, 100 * d.rms_m,
              100 * d.p95_m, 100 * d.share_3cm, 100 * d.share_5cm);
}

void append_distances(const EvalSummary& s, std::string* text) {
  const CloudDistances& d = s.evaluation.distances;
  append_text(text, "\n%-28s%9s%8s%8s%8s%8s%8s%8s\n", "distance [cm]", "count", "mean", "median", "RMS", "p95", "<3cm %", "<5cm %");
  append_row("landmark to point", d.point, text);
  append_row("landmark to surface", d.plane, text);
  append_row("all landmarks to point", d.all, text);
  append_row("cloud cell to landmark", d.cells, text);
  append_text(text, "\n%-22s%llu of %llu landmarks (%.1f %%) are farther than %.2g m from the cloud\n", "outside the scan",
              llu(d.num_outside), llu(s.evaluation.num_used), percent(d.num_outside, s.evaluation.num_used), s.evaluation.max_distance_m);
  append_text(text, "%-22s%.1f %% of %llu cells of the cloud near the keyframes have a landmark within 0.25 m\n", "coverage",
              percent(d.num_covered, d.num_cells), llu(d.num_cells));
}

void append_scale(const Evaluation& e, std::string* text) {
  if (e.scale) append_text(text, "%-22s%.4f by ICP (expected 1 +- 0.01)\n", "scale", *e.scale);
  if (e.points_scale) append_text(text, "%-22s%.4f by the control points (1 +- %.2f)\n", "", *e.points_scale, e.points_scale_tolerance);
  if (e.poses_scale) append_text(text, "%-22s%.4f by the camera positions (1 +- %.2f)\n", "", *e.poses_scale, e.poses_scale_tolerance);
  const Eigen::Vector3d &m = e.distances.map_extent_m, &c = e.distances.cloud_extent_m;
  append_text(text, "%-22smap %.1f x %.1f x %.1f m, cloud %.1f x %.1f x %.1f m, volumes %.3g : 1\n", "boxes", m.x(), m.y(), m.z(), c.x(),
              c.y(), c.z(), e.distances.volume_ratio());
}

Json to_json(const DistanceStatistics& d) {
  return {{"count", d.count}, {"mean_m", d.mean_m}, {"median_m", d.median_m},   {"rms_m", d.rms_m},
          {"p95_m", d.p95_m}, {"max_m", d.max_m},   {"share_3cm", d.share_3cm}, {"share_5cm", d.share_5cm}};
}

Json to_json(const Rigid3& T) { return {{"translation_m", json_of(T.translation)}, {"rotation_wxyz", json_of(T.rotation)}}; }

Json to_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json alignment_json(const Evaluation& e) {
  Json json{{"start", describe(e.start)}};
  if (e.search)
    json["search"] = {{"is_map_frame", e.search->is_identity},
                      {"score_m", e.search->score_m},
                      {"rival_score_m", e.search->rival_score_m},
                      {"starts", e.search->num_starts}};
  json["T_cloud_map_start"] = to_json(e.T_cloud_map_start);
  json["T_cloud_map"] = to_json(e.T_cloud_map);
  if (e.registration) {
    const Registration& r = *e.registration;
    json["icp"] = {{"iterations", r.num_iterations},
                   {"converged", r.is_converged},
                   {"points", r.num_points},
                   {"correspondences", r.num_correspondences},
                   {"rms_m", r.rms_m},
                   {"moved_m", e.moved_m},
                   {"moved_deg", degrees(e.moved_rad)},
                   {"weakest_share", r.weakest_share},
                   {"weakest_direction", json_of(r.weakest_direction)}};
  }
  for (const PointResidual& point : e.residuals) {
    json["control_points"].push_back({{"name", point.name},
                                      {"sigma_m", point.sigma_m},
                                      {"residual_fit_m", json_of(point.aligned_m)},
                                      {"residual_icp_m", json_of(point.final_m)}});
  }
  return json;
}

}  // namespace

std::string format_table(const EvalSummary& s) {
  std::string text;
  append_inputs(s, &text);
  append_alignment(s, &text);
  append_points(s.evaluation, &text);
  append_distances(s, &text);
  append_scale(s.evaluation, &text);
  for (const std::string& file : s.files) append_text(&text, "%-22s%s\n", "written", file.c_str());
  append_text(&text, "%-22s%.1f s\n", "time", s.seconds);
  for (const std::string& warning : all_warnings(s)) append_text(&text, "WARNING %s\n", warning.c_str());
  return text;
}

std::string format_json(const EvalSummary& s) {
  const Evaluation& e = s.evaluation;
  const CloudDistances& d = e.distances;
  Json json;
  json["map"] = s.map_path;
  json["landmarks"] = {{"total", e.num_landmarks}, {"used", e.num_used}, {"min_observations", s.min_observations}};
  json["keyframes"] = e.num_keyframes;
  json["cloud"] = {{"name", s.cloud_name}, {"read", s.num_read}, {"invalid", s.num_invalid}, {"kept", s.num_points},
                   {"voxel_m", s.voxel_m}, {"unit_m", s.unit_m}, {"unit_from", s.unit_from}, {"notes", s.cloud_notes}};
  json["alignment"] = alignment_json(e);
  json["distances"] = {{"landmark_to_point", to_json(d.point)},         {"landmark_to_surface", to_json(d.plane)},
                       {"all_landmarks_to_point", to_json(d.all)},      {"cell_to_landmark", to_json(d.cells)},
                       {"max_distance_m", s.evaluation.max_distance_m}, {"landmarks_outside", d.num_outside}};
  json["coverage"] = {{"cells", d.num_cells}, {"covered", d.num_covered}, {"share", percent(d.num_covered, d.num_cells) / 100}};
  json["scale"] = {{"icp", to_json(e.scale)},
                   {"icp_sigma", to_json(e.sigma_scale)},
                   {"control_points", to_json(e.points_scale)},
                   {"camera_positions", to_json(e.poses_scale)},
                   {"map_extent_m", json_of(d.map_extent_m)},
                   {"cloud_extent_m", json_of(d.cloud_extent_m)},
                   {"volume_ratio", d.volume_ratio()}};
  json["warnings"] = all_warnings(s);
  json["files"] = s.files;
  return tools::json_text(json);
}

}  // namespace camloc::mapping
