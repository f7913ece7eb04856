// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the map lies in the site, from control points: a rigid fit, what each point says of it, and whether it can be
// believed. A wrong point is named, never averaged away.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/alignment.h"
#include "core/geometry/wcs.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {

enum class PointVerdict {
  kGood,
  kHigh,      ///< off by more than its accuracy explains, but within the tolerance
  kSuspect,   ///< the others agree with each other and not with this one
  kUnclear,   ///< something is wrong, and it may be this one
  kExcluded,  ///< a suspect, left out because the user said so
};
/// "A, B, C and 5 more": `most` of the names.
[[nodiscard]] std::string joined(const std::vector<std::string>& names, std::size_t most = 8);
/// False for suspects, which bend the residuals of all others, and excluded points.
[[nodiscard]] bool is_in_fit(PointVerdict verdict);
[[nodiscard]] const char* to_string(PointVerdict verdict);

/// A control point that the map knows.
struct GeorefPoint {
  std::string name;
  PointPair pair;  ///< a: wcs, b: map; sigma of both
  std::size_t num_measurements = 1;
  double scatter_m = 0;
  Eigen::Vector3d residual_m = Eigen::Vector3d::Zero();  ///< wcs coordinates minus fitted ones
  LeaveOneOutResidual left_out;                          ///< where the other points of the fit put it
  PointVerdict verdict = PointVerdict::kGood;
};

struct GeorefOptions {
  double tolerance_m = 0.10;  ///< a point that is off by less is never a suspect
  bool is_excluding_suspects = false;
  /// Up in the map, rough, to tell which axes were exchanged and to warn where z is not up.
  std::optional<Eigen::Vector3d> up_map;
};

struct GeorefFit {
  std::vector<GeorefPoint> points;
  bool is_fitted = false;       ///< the numbers below exist
  Alignment rigid, similarity;  ///< of the points that are in the fit
  WcsDatum datum;
  double covariance_factor = 1;    ///< what the residuals say over what the sigmas say, at least 1; in datum.covariance
  double rms_leave_one_out_m = 0;  ///< over the points of the fit that their others determine
  std::string problem;             ///< why the fit must not be used; empty when it may
  std::vector<std::string> warnings;
};

/// Control points with the measurements of the same name, in the order of the points.
[[nodiscard]] std::vector<GeorefPoint> match_points(const std::vector<ControlPoint>& points, const std::vector<ObservedPoint>& observed);

[[nodiscard]] GeorefFit fit_georef(std::vector<GeorefPoint> points, const GeorefOptions& options);

/// What `camloc map georef` says: the residual table, the datum, and what is wrong (georef_report.cc).
struct GeorefSummary {
  std::string map_path, points_path, observed_path, out_path;
  GeorefFit fit;
  std::vector<std::string> left_out;                          ///< observations without a point
  std::vector<std::string> only_in_points, only_in_observed;  ///< names without partner
  bool is_written = false;
  bool has_replaced_datum = false;
};

[[nodiscard]] std::string format_table(const GeorefSummary& summary);
[[nodiscard]] std::string format_json(const GeorefSummary& summary);

}  // namespace camloc::mapping
