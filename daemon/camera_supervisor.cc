// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/camera_supervisor.h"

#include <algorithm>
#include <limits>

namespace camloc {

void CameraSupervisor::on_opened(std::int64_t now_ns, bool is_live) {
  is_live_ = is_live;
  // During a stall the step that led here has set how long to wait, if not from when on.
  deadline_ns_ = now_ns + (is_stalled_ ? std::max(patience_ns_, options_.first_frame_ns) : options_.first_frame_ns);
  if (!is_stalled_) last_frame_ns_ = now_ns;
}

bool CameraSupervisor::on_frame(std::int64_t now_ns) {
  const bool was_stalled = is_stalled_;
  if (was_stalled) last_recovery_ns_ = now_ns - last_frame_ns_;
  is_stalled_ = false;
  last_step_ = RecoveryStep::kNone;
  patience_ns_ = options_.first_frame_ns;
  last_frame_ns_ = now_ns;
  deadline_ns_ = now_ns + options_.stall_ns;
  return was_stalled;
}

void CameraSupervisor::on_corrupt_frame(std::int64_t now_ns) {
  if (is_stalled_) return;  // the ladder is under way: only a whole frame ends it
  deadline_ns_ = std::max(deadline_ns_, std::min(now_ns + options_.stall_ns, last_frame_ns_ + options_.corrupt_ns));
}

RecoveryStep CameraSupervisor::take_due_step(std::int64_t now_ns) {
  if (!is_live_ || now_ns < deadline_ns_) return RecoveryStep::kNone;
  is_stalled_ = true;
  switch (last_step_) {
    case RecoveryStep::kNone: last_step_ = RecoveryStep::kRestartStream; break;
    case RecoveryStep::kRestartStream:
    case RecoveryStep::kResetDevice: last_step_ = RecoveryStep::kReopen; break;
    case RecoveryStep::kReopen:
      last_step_ = RecoveryStep::kResetDevice;
      patience_ns_ = std::min(2 * std::max(patience_ns_, options_.first_frame_ns), options_.longest_patience_ns);
      break;
  }
  deadline_ns_ = now_ns + std::max(patience_ns_, options_.first_frame_ns);
  return last_step_;
}

std::int64_t CameraSupervisor::time_left_ns(std::int64_t now_ns) const {
  if (!is_live_) return std::numeric_limits<std::int64_t>::max();
  return std::max<std::int64_t>(deadline_ns_ - now_ns, 0);
}

}  // namespace camloc
