// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Read fit_georef() at the end first.
#include "tools/mapping/site/georef_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "tools/common/text_format.h"
#include "tools/mapping/site/consensus.h"

namespace camloc::mapping {
namespace {

using tools::degrees;
using tools::text_of;

constexpr double kMaxTurnSigmaRad = 0.05;  ///< 3 degrees: 50 cm at 10 m
constexpr double kHighSigmas = 4;
constexpr double kMaxScaleError = 0.01;
constexpr std::size_t kMaxPoints = 2000;  ///< each is left out once

std::vector<PointPair> pairs_of(const std::vector<GeorefPoint>& points) {
  std::vector<PointPair> pairs;
  for (const GeorefPoint& point : points) {
    if (is_in_fit(point.verdict)) pairs.push_back(point.pair);
  }
  return pairs;
}

template <typename Predicate>
std::vector<std::string> names_where(const std::vector<GeorefPoint>& points, const Predicate& holds) {
  std::vector<std::string> names;
  for (const GeorefPoint& point : points) {
    if (holds(point.verdict)) names.push_back(point.name);
  }
  return names;
}

/// Why these points do not determine where the map lies; empty when they do.
std::string explain_rank(std::span<const PointPair> pairs) {
  if (pairs.size() < 3) {
    return text_of("%zu common control point%s; at least 3 that are not on a line are needed, better 4 or more so that errors are found",
                   pairs.size(), pairs.size() == 1 ? "" : "s");
  }
  if (pairs.size() > kMaxPoints) return text_of("%zu common control points; choose at most %zu", pairs.size(), kMaxPoints);
  const Alignment alignment = align_rigid(pairs);
  if (alignment.rank == AlignmentRank::kPosition) return "all control points are in one place";
  const Eigen::Matrix3d turn = alignment.covariance.bottomRightCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(turn);
  const double sigma_rad = std::sqrt(eigen.eigenvalues()[2]);
  if (alignment.rank == AlignmentRank::kFull && sigma_rad < kMaxTurnSigmaRad) return "";
  const Eigen::Vector3d axis = eigen.eigenvectors().col(2);
  const std::string direction = text_of("(%.2f, %.2f, %.2f)", axis.x(), axis.y(), axis.z());
  const std::string known =
      alignment.rank == AlignmentRank::kLine ? "not known" : text_of("known only to %.0f deg", std::min(180.0, degrees(sigma_rad)));
  return "the control points lie on a line, direction " + direction + ": the turn about it is " + known + "; add a point beside the line";
}

/// The two points whose distance in the site differs most from that in the map.
std::string worst_distance(const std::vector<GeorefPoint>& points) {
  double worst = -1;
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(points.size(), 200); ++i) {
    for (std::size_t j = i + 1; j < std::min<std::size_t>(points.size(), 200); ++j) {
      const double in_site = (points[i].pair.p_a - points[j].pair.p_a).norm(), in_map = (points[i].pair.p_b - points[j].pair.p_b).norm();
      if (std::abs(in_site - in_map) <= worst) continue;
      worst = std::abs(in_site - in_map);
      text =
          "from " + points[i].name + " to " + points[j].name + text_of(" it is %.3f m in the site and %.3f m in the map", in_site, in_map);
    }
  }
  return text;
}

/// Marks what the consensus says of each point and returns why the fit must not be used as it is.
std::string judge(const Consensus& consensus, const GeorefOptions& options, GeorefFit* fit) {
  const std::size_t count = fit->points.size();
  if (consensus.num_inliers == count) return "";
  const std::vector<PointPair> pairs = pairs_of(fit->points);
  const bool has_majority = consensus.has_majority();
  // First of all: some points agree with a wrong axis, too, for example those near one plane.
  const std::string axes = explain_misfit(pairs, consensus.num_inliers, options.tolerance_m, options.up_map);
  if (!axes.empty() || !has_majority || consensus.is_ambiguous) {
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_doubtful = !axes.empty() || !has_majority || !consensus.is_inlier[i] || consensus.is_outlier_elsewhere[i];
      if (is_doubtful) fit->points[i].verdict = PointVerdict::kUnclear;
    }
    if (!axes.empty()) return axes;
    return "the points contradict each other and it cannot be told which one is wrong: " + worst_distance(fit->points) + "; check " +
           joined(names_where(fit->points, [](PointVerdict v) { return v == PointVerdict::kUnclear; })) + " or add points";
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (consensus.is_inlier[i]) continue;
    fit->points[i].verdict = options.is_excluding_suspects ? PointVerdict::kExcluded : PointVerdict::kSuspect;
  }
  return "";
}

void compute(GeorefFit* fit) {
  const std::vector<PointPair> pairs = pairs_of(fit->points);
  fit->rigid = align_rigid(pairs);
  fit->similarity = align_similarity(pairs);
  fit->is_fitted = true;
  if (fit->rigid.degrees_of_freedom > 0) { fit->covariance_factor = std::max(1.0, fit->rigid.chi_squared / fit->rigid.degrees_of_freedom); }
  fit->datum = {fit->rigid.T_a_b, fit->covariance_factor * fit->rigid.covariance};

  const std::vector<LeaveOneOutResidual> left_out = leave_one_out(pairs);
  double sum_squared = 0;
  std::size_t next = 0, num_determined = 0;
  for (GeorefPoint& point : fit->points) {
    point.residual_m = point.pair.p_a - fit->rigid.map(point.pair.p_b);
    point.left_out = is_in_fit(point.verdict) ? left_out[next++] : predicted_residual(fit->rigid, point.pair);
    if (is_in_fit(point.verdict) && point.left_out.is_determined) {
      sum_squared += point.left_out.error_m.squaredNorm();
      ++num_determined;
    }
    if (point.verdict == PointVerdict::kGood && point.left_out.is_determined && point.left_out.sigmas() > kHighSigmas) {
      point.verdict = PointVerdict::kHigh;
    }
  }
  if (num_determined > 0) fit->rms_leave_one_out_m = std::sqrt(sum_squared / static_cast<double>(num_determined));
}

std::string explain_suspects(const GeorefFit& fit) {
  std::vector<std::string> texts;
  for (const GeorefPoint& point : fit.points) {
    if (point.verdict != PointVerdict::kSuspect) continue;
    const Eigen::Vector3d& error = point.left_out.error_m;
    Eigen::Index axis = 0;
    error.cwiseAbs().maxCoeff(&axis);
    texts.push_back(point.name + text_of(" is %.2f m from where the others put it (d%c %+.2f m)", error.norm(), "xyz"[axis], error[axis]));
  }
  return joined(texts) + "; correct it, or leave it out with --exclude-suspects, or allow it with --tolerance";
}

void add_warnings(const GeorefOptions& options, GeorefFit* fit) {
  const double scale_sigma = fit->similarity.scale_sigma * std::sqrt(fit->covariance_factor);
  const double scale_error = fit->similarity.scale - 1;
  if (std::abs(scale_error) > kMaxScaleError && std::abs(scale_error) > 2 * scale_sigma) {
    fit->warnings.push_back(
        text_of("the site is %.1f %% %s than the map (similarity scale %.4f +- %.4f): check the depth scale of the camera "
                "file and the unit of the points",
                100 * std::abs(scale_error), scale_error > 0 ? "larger" : "smaller", fit->similarity.scale, scale_sigma));
  }
  if (options.up_map) {
    if (const std::string warning = check_up(fit->rigid.T_a_b, *options.up_map); !warning.empty()) fit->warnings.push_back(warning);
  }
  if (fit->rigid.degrees_of_freedom <= 3) {
    fit->warnings.push_back("with 3 points an error cannot be found by the others: measure a fourth one");
  }
}

}  // namespace

std::string joined(const std::vector<std::string>& names, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > most) text += " and " + std::to_string(names.size() - most) + " more";
  return text;
}

bool is_in_fit(PointVerdict verdict) { return verdict != PointVerdict::kExcluded && verdict != PointVerdict::kSuspect; }

const char* to_string(PointVerdict verdict) {
  constexpr const char* kWords[] = {"good", "high", "SUSPECT", "UNCLEAR", "excluded"};
  return kWords[static_cast<std::size_t>(verdict)];
}

std::vector<GeorefPoint> match_points(const std::vector<ControlPoint>& points, const std::vector<ObservedPoint>& observed) {
  std::map<std::string, const ObservedPoint*> by_name;
  for (const ObservedPoint& point : observed) by_name.emplace(point.name, &point);
  std::vector<GeorefPoint> matched;
  for (const ControlPoint& point : points) {
    const auto found = by_name.find(point.name);
    if (found == by_name.end()) continue;
    const ObservedPoint& seen = *found->second;
    const PointPair pair{point.p_wcs, seen.p_map, std::hypot(point.sigma_m, seen.sigma_m)};
    matched.push_back(
        {.name = point.name, .pair = pair, .num_measurements = seen.num_measurements, .scatter_m = seen.scatter_m, .left_out = {}});
  }
  return matched;
}

GeorefFit fit_georef(std::vector<GeorefPoint> points, const GeorefOptions& options) {
  GeorefFit fit;
  fit.points = std::move(points);
  fit.problem = explain_rank(pairs_of(fit.points));
  if (!fit.problem.empty()) return fit;

  const Consensus consensus = find_consensus(pairs_of(fit.points), options.tolerance_m);
  fit.problem = judge(consensus, options, &fit);
  if (fit.problem.empty()) {
    // The points that agree may be too few, or on a line.
    fit.problem = explain_rank(pairs_of(fit.points));
    if (!fit.problem.empty()) {
      fit.problem =
          "without the suspects " + joined(names_where(fit.points, [](PointVerdict v) { return !is_in_fit(v); })) + ": " + fit.problem;
      return fit;
    }
  }
  compute(&fit);
  const auto is_suspect = [](const GeorefPoint& point) { return point.verdict == PointVerdict::kSuspect; };
  if (std::any_of(fit.points.begin(), fit.points.end(), is_suspect)) fit.problem = explain_suspects(fit);
  if (!fit.problem.empty()) return fit;
  if (options.up_map) fit.problem = explain_upside_down(pairs_of(fit.points), fit.rigid, *options.up_map);
  add_warnings(options, &fit);
  return fit;
}

}  // namespace camloc::mapping
