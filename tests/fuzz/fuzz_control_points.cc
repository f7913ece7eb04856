// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary text as the two files of control points: values that can be used, or an error in one line. What can be read is
// fitted, too: a fit is finite or says why there is none.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>

#include "tools/mapping/site/control_points.h"
#include "tools/mapping/site/georef_fit.h"

namespace {

using namespace camloc::mapping;

void require(bool condition) {
  if (!condition) std::abort();
}

bool is_one_line(const std::string& text) { return !text.empty() && text.find('\n') == std::string::npos; }

void check_observations(const std::string& text) {
  const auto observations = parse_control_observations(text, "fuzz");
  if (!observations) return require(is_one_line(observations.status().message()));
  for (const ControlObservation& observation : *observations) {
    require(!observation.name.empty() && observation.p_map.allFinite() && std::isfinite(observation.u) && std::isfinite(observation.v));
    require(observation.sigma > 0 || (observation.kind == ObservationKind::kLandmark && observation.sigma == 0));
    require(is_one_line(describe(observation)));
  }
}

/// As if the map had the same points in another order of axes, and the first one wrong.
void check_fit(const std::vector<ControlPoint>& points) {
  std::vector<ObservedPoint> observed;
  for (const ControlPoint& point : points) {
    if (observed.size() == 8) break;
    observed.push_back({point.name, {point.p_wcs.y(), point.p_wcs.z(), point.p_wcs.x()}, 0.02, 0, 1, ""});
  }
  observed.front().p_map.x() += 1;
  GeorefOptions options;
  options.up_map = Eigen::Vector3d::UnitZ();
  options.is_excluding_suspects = points.size() % 2 == 0;
  const GeorefFit fit = fit_georef(match_points(points, observed), options);
  require(fit.problem.find('\n') == std::string::npos);
  if (!fit.problem.empty()) return;
  require(fit.is_fitted && fit.datum.T_wcs_map.translation.allFinite() && fit.datum.covariance.allFinite());
  require(std::abs(fit.datum.T_wcs_map.rotation.norm() - 1) < 1e-9);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  check_observations(text);
  const auto points = parse_control_points(text, "fuzz");
  if (!points) {
    require(is_one_line(points.status().message()));
    return 0;
  }
  std::set<std::string> names;
  for (const ControlPoint& point : *points) {
    require(names.insert(point.name).second && !point.name.empty() && point.p_wcs.allFinite() && point.sigma_m > 0);
  }
  check_fit(*points);
  return 0;
}
