// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc/eval_risk.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

Json coverage_json(const Coverage& coverage) {
  return {{"poses", coverage.num_poses},
          {"ellipsoid_95", coverage.ellipsoid_95},
          {"protection_95", coverage.protection_95},
          {"protection_999", coverage.protection_999},
          {"position_999", coverage.position_999},
          {"rotation_999", coverage.rotation_999}};
}

void print_coverage(const char* name, const Coverage& coverage) {
  std::printf("inside        %-8s 95 %% ellipsoid %.1f %%, 95 %% protection %.1f %%, 99.9 %% protection %.2f %% (of %llu)\n", name,
              100 * coverage.ellipsoid_95, 100 * coverage.protection_95, 100 * coverage.protection_999, llu(coverage.num_poses));
}

}  // namespace

Result<JudgedRun> judge_all(const RiskArguments& arguments, const ReferencePose& reference, const Rigid3& T_reference_estimate) {
  auto all = judge_records(arguments.records_path, reference, T_reference_estimate);
  if (!all) return all.status();
  for (std::size_t i = 0; i + 1 < arguments.also.size(); i += 2) {
    const auto poses = read_recorded_poses(arguments.also[i + 1], "", std::nullopt);
    if (!poses) return poses.status();
    const auto run = judge_records(arguments.also[i], [&](std::int64_t stamp_ns) { return pose_at(poses->poses, stamp_ns); }, {});
    if (!run) return run.status();
    all->num_frames += run->num_frames;
    all->poses.insert(all->poses.end(), run->poses.begin(), run->poses.end());
  }
  return all;
}

Json risk_json(const RiskReport& report) {
  Json bins = Json::array(), thresholds = Json::array(), nees = Json::array();
  for (const RiskBin& bin : report.bins) {
    bins.push_back({{"from", bin.from},
                    {"to", bin.to},
                    {"poses", bin.num_poses},
                    {"promised", bin.promised},
                    {"misleading", bin.num_misleading},
                    {"localized", bin.num_localized},
                    {"localized_misleading", bin.num_localized_misleading}});
  }
  for (const RiskThreshold& threshold : report.thresholds) {
    thresholds.push_back({{"max_risk", threshold.max_risk},
                          {"availability", threshold.availability},
                          {"misleading", threshold.num_misleading},
                          {"misleading_share", threshold.misleading_share}});
  }
  for (const NeesBin& bin : report.nees) {
    nees.push_back({{"min_inliers", bin.min_inliers},
                    {"max_inliers", bin.max_inliers},
                    {"poses", bin.num_poses},
                    {"mean", bin.mean},
                    {"ellipsoid_95", bin.ellipsoid_95}});
  }
  return {{"frames", report.num_frames},
          {"localized", report.num_localized},
          {"bins", bins},
          {"inside", {{"all", coverage_json(report.all)}, {"hardest_quarter", coverage_json(report.hardest)}}},
          {"thresholds", thresholds},
          {"nees", nees}};
}

Json risk_json(const RiskFit& fit) {
  Json weights;
  for (std::size_t i = 0; i < fit.weights.size(); ++i) weights[risk_weights()[i].name] = fit.weights[i];
  return {{"poses", fit.num_poses},
          {"misleading", fit.num_faults},
          {"weights", weights},
          {"position_sigmas", {fit.position_sigmas_95, fit.position_sigmas_999}},
          {"rotation_sigmas", {fit.rotation_sigmas_95, fit.rotation_sigmas_999}}};
}

void print_risk(const RiskReport& report) {
  std::printf("risk          %10s %10s %8s %10s %10s %10s\n", "promised", "observed", "poses", "misleading", "LOCALIZED", "misleading");
  for (const RiskBin& bin : report.bins) {
    if (bin.num_poses == 0) continue;
    std::printf("%5.4g to %-5.4g %9.2f%% %9.2f%% %8llu %10llu %10llu %10llu%s\n", bin.from, bin.to, 100 * bin.promised,
                100 * bin.observed(), llu(bin.num_poses), llu(bin.num_misleading), llu(bin.num_localized),
                llu(bin.num_localized_misleading), bin.num_poses < kMinPosesOfBin ? "  (few)" : "");
  }
  print_coverage("all", report.all);
  print_coverage("hardest", report.hardest);
  // Where the limit makes a difference: availability in steps of a tenth.
  double next = 0;
  for (const RiskThreshold& threshold : report.thresholds) {
    if (threshold.availability < next && &threshold != &report.thresholds.back()) continue;
    std::printf("risk up to    %.4f: %5.1f %% of all frames, %llu misleading (%.2f %%)\n", threshold.max_risk, 100 * threshold.availability,
                llu(threshold.num_misleading), 100 * threshold.misleading_share);
    next = threshold.availability + 0.1;
  }
  for (const NeesBin& bin : report.nees) {
    std::printf("%4u to %-4u inliers  NEES mean %6.2f, %5.1f %% inside the 95 %% ellipsoid (of %llu)\n", bin.min_inliers, bin.max_inliers,
                bin.mean, 100 * bin.ellipsoid_95, llu(bin.num_poses));
  }
}

void print_risk(const RiskFit& fit) {
  std::printf("calibration   %llu poses, %llu misleading\n", llu(fit.num_poses), llu(fit.num_faults));
  for (std::size_t i = 0; i < fit.weights.size(); ++i) std::printf("  {\"%s\", %.2f},\n", risk_weights()[i].name, fit.weights[i]);
  std::printf("error in sigmas of the worst axis, 95 and 99.9 %%: position %.2f %.2f, rotation %.2f %.2f\n", fit.position_sigmas_95,
              fit.position_sigmas_999, fit.rotation_sigmas_95, fit.rotation_sigmas_999);
}

}  // namespace camloc::tools
