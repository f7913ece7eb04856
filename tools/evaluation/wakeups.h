// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The kidnapped robot: a localizer that is switched on at many places of a recording, each time knowing nothing. Is its first pose
// right, how long does it take, and does any later one mislead?
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "core/localize/localizer.h"
#include "tools/evaluation/coarse_asking.h"
#include "tools/evaluation/trajectory_error.h"

namespace camloc::tools {

/// What became of one cold start.
struct Wakeup {
  std::uint64_t first_frame = 0;  ///< sequence number
  std::int64_t start_ns = 0;
  std::optional<Rigid3> T_map_camera_start;  ///< the truth, where it is known
  std::uint32_t num_frames = 0;
  std::uint32_t num_localized = 0;
  std::uint32_t num_misleading = 0;      ///< LOCALIZED and farther off than kMisleading
  std::optional<double> seconds_to_fix;  ///< from the first frame to the first LOCALIZED one; 0: in that frame
  bool is_first_fix_misleading = false;
  double first_fix_error_m = 0;
  Reason last_reason = Reason::kNotStarted;
  bool is_complete = false;  ///< ran for its whole time; otherwise the recording ended before
};

struct WakeupOptions {
  std::uint64_t count = 200;  ///< starts, evenly over the frames
  double seconds = 3;         ///< each runs for this long
};

/// Starts and feeds the localizers. Not thread-safe.
class WakeupRun {
 public:
  /// `map`, `reference` and `coarse` must outlive this. `num_frames`: of the recording. `coarse`: asked about lost frames, may be null.
  WakeupRun(const MapView& map, const RgbdCamera& camera, const LocalizerOptions& localizer, ReferencePose reference,
            const WakeupOptions& options, std::uint64_t num_frames, CoarseAsking* coarse = nullptr);
  /// The next frame of the recording.
  void process(const Frame& frame);
  /// In the order of their starts.
  [[nodiscard]] std::span<const Wakeup> results() const { return results_; }

 private:
  struct Active {
    std::size_t index;  ///< in results_
    std::unique_ptr<Localizer> localizer;
  };
  void start(const Frame& frame);
  void judge(const Localization& result, Wakeup* wakeup) const;

  const MapView* map_;
  RgbdCamera camera_;
  LocalizerOptions localizer_options_;
  ReferencePose reference_;
  CoarseAsking* coarse_;
  std::int64_t duration_ns_;
  std::set<std::uint64_t> starts_;  ///< frames, counted from the first that is processed
  std::uint64_t num_processed_ = 0;
  std::vector<Active> active_;
  std::vector<Wakeup> results_;
};

struct WakeupSummary {
  std::uint64_t num_starts = 0, num_cut_short = 0;  ///< the latter not fixed before the recording ended
  std::uint64_t num_fixed = 0, num_fixed_at_once = 0, num_never = 0, num_wrong_first = 0;
  std::uint64_t num_localized = 0, num_misleading = 0;  ///< frames
  double fix_p50_s = 0, fix_p95_s = 0;                  ///< of those fixed
};
[[nodiscard]] WakeupSummary summarize(std::span<const Wakeup> wakeups);

}  // namespace camloc::tools
