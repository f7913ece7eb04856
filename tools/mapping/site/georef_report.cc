// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/common/json_text.h"
#include "tools/common/text_format.h"
#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {
namespace {

using tools::append_text;
using tools::degrees;
using tools::Json;
using tools::json_of;

constexpr std::size_t kMaxNameColumns = 24;

/// Standard deviations of position (m) and of the turn (rad) over the three axes.
struct DatumSigmas {
  double position_m = 0, turn_rad = 0;
};

/// The position is that of the middle of the control points: at the map's origin the turn would be in it a second time.
DatumSigmas sigmas_of(const GeorefFit& fit) {
  double weight = 0;
  for (const GeorefPoint& point : fit.points) {
    if (is_in_fit(point.verdict)) weight += 1 / (point.pair.sigma_m * point.pair.sigma_m);
  }
  const double turn_variance = fit.datum.covariance.bottomRightCorner<3, 3>().trace() / 3;
  return {std::sqrt(fit.covariance_factor / weight), std::sqrt(turn_variance)};
}

void append_point(const GeorefPoint& point, int name_columns, std::string* text) {
  const Eigen::Vector3d& d = point.residual_m;
  append_text(text, "%-*.*s %8.3f %8.3f %8.3f %8.3f %7.3f ", name_columns, name_columns, point.name.c_str(), d.x(), d.y(), d.z(), d.norm(),
              point.pair.sigma_m);
  if (point.left_out.is_determined)
    append_text(text, "%9.3f %6.1f  ", point.left_out.error_m.norm(), point.left_out.sigmas());
  else
    append_text(text, "%9s %6s  ", "-", "-");
  *text += to_string(point.verdict);
  if (point.num_measurements > 1) append_text(text, "  %zu measurements, scatter %.3f", point.num_measurements, point.scatter_m);
  *text += "\n";
}

void append_points(const GeorefFit& fit, std::string* text) {
  std::size_t longest = 5;
  for (const GeorefPoint& point : fit.points) longest = std::max(longest, point.name.size());
  const int name_columns = static_cast<int>(std::min(longest, kMaxNameColumns));
  append_text(text, "%-*s %8s %8s %8s %8s %7s %9s %6s  %s\n", name_columns, "point", "dx", "dy", "dz", "norm", "sigma", "predicted",
              "sigmas", "verdict");
  for (const GeorefPoint& point : fit.points) append_point(point, name_columns, text);
  *text += "Metres, site minus fit. 'predicted': how far the point is from where the others put it, also in standard deviations.\n\n";
}

/// The datum that was found, also where it is not written because of a suspect.
bool is_usable(const GeorefFit& fit) {
  return std::none_of(fit.points.begin(), fit.points.end(),
                      [](const GeorefPoint& point) { return point.verdict == PointVerdict::kUnclear; });
}

void append_fit(const GeorefFit& fit, std::string* text) {
  const auto num_used =
      std::count_if(fit.points.begin(), fit.points.end(), [](const GeorefPoint& point) { return is_in_fit(point.verdict); });
  append_text(text, "%-14s%.3f m over %d points; predicted from the others %.3f m\n", "RMS", fit.rigid.rms_m, static_cast<int>(num_used),
              fit.rms_leave_one_out_m);
  if (!is_usable(fit)) return;
  append_text(text, "%-14s%.5f +- %.5f with free scale (written is the rigid fit, scale 1)\n", "scale", fit.similarity.scale,
              fit.similarity.scale_sigma * std::sqrt(fit.covariance_factor));
  const Eigen::Vector3d& t = fit.datum.T_wcs_map.translation;
  const Eigen::Quaterniond& q = fit.datum.T_wcs_map.rotation;
  append_text(text, "%-14sposition %.4f %.4f %.4f m, rotation wxyz %.7f %.7f %.7f %.7f\n", "T_wcs_map", t.x(), t.y(), t.z(), q.w(), q.x(),
              q.y(), q.z());
  const DatumSigmas sigmas = sigmas_of(fit);
  append_text(text, "%-14s%.3f m amid the points, %.3f deg, per axis", "uncertainty", sigmas.position_m, degrees(sigmas.turn_rad));
  if (fit.covariance_factor > 1) append_text(text, " (residuals are %.1f times the sigmas: scaled up)", std::sqrt(fit.covariance_factor));
  *text += "\n";
}

void append_line(const char* label, const std::string& content, std::string* text) {
  if (!content.empty()) *text += tools::text_of("%-13s ", label) + content + "\n";
}

Json point_json(const GeorefPoint& point) {
  Json json{{"name", point.name},
            {"site_m", json_of(point.pair.p_a)},
            {"map_m", json_of(point.pair.p_b)},
            {"sigma_m", point.pair.sigma_m},
            {"measurements", point.num_measurements},
            {"scatter_m", point.scatter_m},
            {"residual_m", json_of(point.residual_m)}};
  if (point.left_out.is_determined) {
    json["predicted_error_m"] = json_of(point.left_out.error_m);
    json["predicted_error_sigmas"] = point.left_out.sigmas();
  }
  json["verdict"] = to_string(point.verdict);
  return json;
}

Json fit_json(const GeorefFit& fit) {
  const Rigid3& T_wcs_map = fit.datum.T_wcs_map;
  const DatumSigmas sigmas = sigmas_of(fit);
  return {{"rms_m", fit.rigid.rms_m},
          {"rms_predicted_m", fit.rms_leave_one_out_m},
          {"scale", fit.similarity.scale},
          {"scale_sigma", fit.similarity.scale_sigma * std::sqrt(fit.covariance_factor)},
          {"covariance_factor", fit.covariance_factor},
          {"sigma_m", sigmas.position_m},
          {"sigma_deg", degrees(sigmas.turn_rad)},
          {"T_wcs_map", {{"position_m", json_of(T_wcs_map.translation)}, {"orientation_wxyz", json_of(T_wcs_map.rotation)}}},
          {"covariance", json_of(fit.datum.covariance)}};
}

}  // namespace

std::string format_table(const GeorefSummary& s) {
  std::string text;
  if (s.fit.is_fitted) {
    append_points(s.fit, &text);
    append_fit(s.fit, &text);
  }
  for (const std::string& left_out : s.left_out) append_line("left out", left_out, &text);
  append_line("not observed", joined(s.only_in_points, s.only_in_points.size()), &text);
  append_line("not surveyed", joined(s.only_in_observed, s.only_in_observed.size()), &text);
  for (const std::string& warning : s.fit.warnings) append_line("WARNING", warning, &text);
  if (s.is_written) append_line("written", s.out_path + (s.has_replaced_datum ? " (its older datum is replaced)" : ""), &text);
  return text;
}

std::string format_json(const GeorefSummary& s) {
  Json json{{"map", s.map_path}, {"points_file", s.points_path}, {"observed_file", s.observed_path}, {"points", Json::array()}};
  if (s.fit.is_fitted) {
    for (const GeorefPoint& point : s.fit.points) json["points"].push_back(point_json(point));
    json["fit"] = fit_json(s.fit);
  }
  json["left_out"] = s.left_out;
  json["not_observed"] = s.only_in_points;
  json["not_surveyed"] = s.only_in_observed;
  json["warnings"] = s.fit.warnings;
  json["problem"] = s.fit.problem.empty() ? Json(nullptr) : Json(s.fit.problem);
  json["written"] = s.is_written ? Json(s.out_path) : Json(nullptr);
  return tools::json_text(json);
}

}  // namespace camloc::mapping
