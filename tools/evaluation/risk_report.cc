// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/risk_report.h"

#include <algorithm>

namespace camloc::tools {
namespace {

constexpr double kChiSquare95 = 12.591587;  // 6 degrees of freedom
constexpr std::array kRiskEdges{0.0, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0};
constexpr std::size_t kNumNeesBins = 8;

bool is_within(const JudgedPose& pose, const ProtectionLevel& level) {
  return pose.error_m <= level.position_m && pose.error_rad <= level.rotation_rad;
}

std::vector<RiskBin> bins_of(std::span<const JudgedPose> poses) {
  std::vector<RiskBin> bins;
  for (std::size_t i = 0; i + 1 < kRiskEdges.size(); ++i) bins.push_back({.from = kRiskEdges[i], .to = kRiskEdges[i + 1]});
  for (const JudgedPose& pose : poses) {
    const auto edge = std::upper_bound(kRiskEdges.begin() + 1, kRiskEdges.end() - 1, pose.integrity_risk);
    RiskBin& bin = bins[static_cast<std::size_t>(edge - kRiskEdges.begin()) - 1];
    ++bin.num_poses;
    bin.promised += pose.integrity_risk;
    bin.num_misleading += pose.is_misleading ? 1 : 0;
    bin.num_localized += pose.is_localized ? 1 : 0;
    bin.num_localized_misleading += pose.is_localized && pose.is_misleading ? 1 : 0;
  }
  for (RiskBin& bin : bins) bin.promised = bin.num_poses == 0 ? 0 : bin.promised / static_cast<double>(bin.num_poses);
  return bins;
}

Coverage coverage_of(std::span<const JudgedPose> poses) {
  Coverage coverage;
  coverage.num_poses = poses.size();
  if (poses.empty()) return coverage;
  const auto share = [&](auto&& holds) {
    return static_cast<double>(std::count_if(poses.begin(), poses.end(), holds)) / static_cast<double>(poses.size());
  };
  coverage.ellipsoid_95 = share([](const JudgedPose& pose) { return pose.nees <= kChiSquare95; });
  coverage.protection_95 = share([](const JudgedPose& pose) { return is_within(pose, pose.protection.p95); });
  coverage.protection_999 = share([](const JudgedPose& pose) { return is_within(pose, pose.protection.p999); });
  coverage.position_999 = share([](const JudgedPose& pose) { return pose.error_m <= pose.protection.p999.position_m; });
  coverage.rotation_999 = share([](const JudgedPose& pose) { return pose.error_rad <= pose.protection.p999.rotation_rad; });
  return coverage;
}

/// One for each promised risk that occurs, ascending.
std::vector<RiskThreshold> thresholds_of(std::vector<JudgedPose> localized, std::uint64_t num_frames) {
  std::sort(localized.begin(), localized.end(),
            [](const JudgedPose& a, const JudgedPose& b) { return a.integrity_risk < b.integrity_risk; });
  std::vector<RiskThreshold> thresholds;
  std::uint64_t num_misleading = 0;
  for (std::size_t i = 0; i < localized.size(); ++i) {
    num_misleading += localized[i].is_misleading ? 1 : 0;
    if (i + 1 < localized.size() && localized[i + 1].integrity_risk <= localized[i].integrity_risk) continue;
    const auto count = static_cast<double>(i + 1);
    thresholds.push_back({localized[i].integrity_risk, num_frames == 0 ? 0 : count / static_cast<double>(num_frames), num_misleading,
                          static_cast<double>(num_misleading) / count});
  }
  return thresholds;
}

/// `localized` ascending by inliers.
std::vector<NeesBin> nees_of(std::span<const JudgedPose> localized) {
  std::vector<NeesBin> bins;
  const std::size_t num_bins = std::min(kNumNeesBins, localized.size());
  for (std::size_t i = 0; i < num_bins; ++i) {
    const std::size_t begin = localized.size() * i / num_bins, end = localized.size() * (i + 1) / num_bins;
    const auto part = localized.subspan(begin, end - begin);
    NeesBin bin{part.front().num_inliers, part.back().num_inliers, part.size(), 0, coverage_of(part).ellipsoid_95};
    for (const JudgedPose& pose : part) bin.mean += pose.nees / static_cast<double>(part.size());
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace

RiskReport make_risk_report(std::span<const JudgedPose> poses, std::uint64_t num_frames) {
  std::vector<JudgedPose> localized;
  std::copy_if(poses.begin(), poses.end(), std::back_inserter(localized), [](const JudgedPose& pose) { return pose.is_localized; });
  std::stable_sort(localized.begin(), localized.end(),
                   [](const JudgedPose& a, const JudgedPose& b) { return a.num_inliers < b.num_inliers; });
  RiskReport report;
  report.num_frames = num_frames;
  report.num_localized = localized.size();
  report.bins = bins_of(poses);
  report.all = coverage_of(localized);
  report.hardest = coverage_of(std::span(localized).first((localized.size() + 3) / 4));
  report.nees = nees_of(localized);
  report.thresholds = thresholds_of(std::move(localized), num_frames);
  return report;
}

}  // namespace camloc::tools
