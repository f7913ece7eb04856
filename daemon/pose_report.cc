// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pose_report.h"

#include <algorithm>

namespace camloc {
namespace {

constexpr double kUnknownVariance = 1e6;
constexpr std::int64_t kMaxAge_ns = 10'000'000'000;  // older than that is not this machine's clock

}  // namespace

PoseReport make_pose_report(const Localization& localization, const PoseContext& context) {
  PoseReport report;
  report.localization = localization;
  report.capture_epoch_ns = localization.stamp_ns + context.stamp_to_epoch_ns;
  const std::int64_t age_ns = context.now_epoch_ns - report.capture_epoch_ns;
  if (context.is_capture_clock_ours && age_ns >= 0 && age_ns < kMaxAge_ns) report.age_ns = age_ns;
  report.map_id = context.map_id;
  report.reset_counter = std::uint64_t{localization.reset_counter} + context.reset_offset;
  report.parent_frame = context.datum != nullptr ? "wcs" : "map";
  report.T_parent_camera.covariance.diagonal().setConstant(kUnknownVariance);
  if (!localization.has_pose) return report;
  report.quality = std::clamp(localization.quality, 0, 100);
  report.T_parent_camera = {localization.T_map_camera, localization.covariance};
  if (context.datum != nullptr) report.T_parent_camera = to_wcs(*context.datum, report.T_parent_camera);
  return report;
}

}  // namespace camloc
