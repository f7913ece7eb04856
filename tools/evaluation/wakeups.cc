// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The recording is read once: runs that overlap in time share its frames, each with a localizer of its own.
#include "tools/evaluation/wakeups.h"

#include <algorithm>
#include <utility>

#include "core/base/order_statistics.h"

namespace camloc::tools {

WakeupRun::WakeupRun(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& localizer, ReferencePose reference,
                     const WakeupOptions& options, std::uint64_t num_frames, CoarseAsking* coarse)
    : map_(&map),
      camera_(camera),
      localizer_options_(localizer),
      reference_(std::move(reference)),
      coarse_(coarse),
      duration_ns_(static_cast<std::int64_t>(options.seconds * 1e9)) {
  const std::uint64_t count = std::min(options.count, num_frames);
  for (std::uint64_t i = 0; i < count; ++i) starts_.insert(i * num_frames / count);
}

void WakeupRun::process(const Frame& frame) {
  if (starts_.contains(num_processed_++)) start(frame);
  std::erase_if(active_, [&](const Active& active) {
    Wakeup& wakeup = results_[active.index];
    wakeup.is_complete = frame.stamp_ns - wakeup.start_ns >= duration_ns_;
    return wakeup.is_complete;
  });
  for (const Active& active : active_) {
    Localizer& localizer = *active.localizer;
    judge(coarse_ != nullptr ? coarse_->process(frame, &localizer) : localizer.process(frame), &results_[active.index]);
  }
}

void WakeupRun::start(const Frame& frame) {
  active_.push_back({results_.size(), std::make_unique<Localizer>(*map_, camera_, localizer_options_)});
  Wakeup wakeup;
  wakeup.first_frame = frame.sequence;
  wakeup.start_ns = frame.stamp_ns;
  wakeup.T_map_camera_start = reference_(frame.stamp_ns);
  results_.push_back(wakeup);
}

void WakeupRun::judge(const Localization& result, Wakeup* wakeup) const {
  ++wakeup->num_frames;
  wakeup->last_reason = result.reason;
  if (result.state != State::kLocalized) return;
  ++wakeup->num_localized;
  const std::optional<Rigid3> truth = reference_(result.stamp_ns);
  const double error_m = truth ? (truth->translation - result.T_map_camera.translation).norm() : 0;
  const bool is_off = truth && is_misleading(*truth, result.T_map_camera);
  wakeup->num_misleading += is_off ? 1 : 0;
  if (wakeup->seconds_to_fix) return;
  wakeup->seconds_to_fix = 1e-9 * static_cast<double>(result.stamp_ns - wakeup->start_ns);
  wakeup->is_first_fix_misleading = is_off;
  wakeup->first_fix_error_m = error_m;
}

WakeupSummary summarize(std::span<const Wakeup> wakeups) {
  WakeupSummary summary;
  summary.num_starts = wakeups.size();
  std::vector<double> seconds;
  for (const Wakeup& wakeup : wakeups) {
    summary.num_localized += wakeup.num_localized;
    summary.num_misleading += wakeup.num_misleading;
    summary.num_wrong_first += wakeup.is_first_fix_misleading ? 1 : 0;
    if (wakeup.seconds_to_fix) {
      seconds.push_back(*wakeup.seconds_to_fix);
      summary.num_fixed_at_once += *wakeup.seconds_to_fix == 0 ? 1 : 0;
    } else {
      ++(wakeup.is_complete ? summary.num_never : summary.num_cut_short);
    }
  }
  summary.num_fixed = seconds.size();
  if (!seconds.empty()) {
    summary.fix_p50_s = lower_quantile(seconds, 0.5);
    summary.fix_p95_s = lower_quantile(seconds, 0.95);
  }
  return summary;
}

}  // namespace camloc::tools
