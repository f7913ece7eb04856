// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of the service that does what others ask for: over the control socket, and hints over LCM.
#include <numbers>

#include "daemon/clock.h"
#include "daemon/service.h"

namespace camloc {

std::string Service::on_control(const ControlRequest& request) {
  switch (request.command) {
    case ControlCommand::kStatus: break;
    case ControlCommand::kReload: return control_reply(reload());
    case ControlCommand::kReset:
      if (!map_.is_loaded()) return control_reply(Status(ErrorCode::kUnavailable, "no map is open, nothing to reset"));
      map_.localizer().reset();
      hint_.reset();
      log_.write(LogLevel::kInfo, "position forgotten on request");
      return control_reply(Status::ok());
    case ControlCommand::kHint: return control_reply(take_hint(request.hint));
  }
  refresh_counters();
  board_.stamp(monotonic_ns(), realtime_ns());
  return control_reply(board_.get());
}

void Service::listen_for_hints() {
  const std::string& channel = in_.config.control_hint_channel;
  if (channel.empty()) return;
  hint_listener_ = std::make_unique<HintListener>(in_.config.publish_lcm_url, channel, [this](const Result<PoseHint>& hint) {
    const Status status = hint ? take_hint(*hint) : hint.status();
    if (status) return hint_trouble_.clear();
    if (hint_trouble_.is_new(status.message())) log_.write(LogLevel::kWarning, "hint over LCM refused: %s", status.message().c_str());
  });
}

Status Service::take_hint(const PoseHint& hint) {
  if (!map_.is_loaded()) return {ErrorCode::kUnavailable, "no map is open, a hint has nothing to refer to"};
  hint_ = hint;
  hint_ns_ = monotonic_ns();
  log_.write(LogLevel::kInfo, "hint: %g %g %g m, heading %g deg, within %g m", hint.position_m.x(), hint.position_m.y(),
             hint.position_m.z(), hint.yaw_rad * 180 / std::numbers::pi, hint.radius_m);
  return Status::ok();
}

// With the frame that comes next. After a while without frames the camera may be anywhere.
void Service::pass_hint_on() {
  if (!hint_) return;
  if (monotonic_ns() - hint_ns_ <= kMaxHintAge_ns) {
    map_.localizer().hint(*hint_);
  } else {
    log_.write(LogLevel::kWarning, "hint dropped: no frame came in time");
  }
  hint_.reset();
}

}  // namespace camloc
