// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said on the control socket: one line with a command in, one line of JSON out. Pure text, no socket.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/localize/pose_hint.h"
#include "daemon/pose_report.h"

namespace camloc {

enum class ControlCommand : std::uint8_t { kStatus, kReload, kReset, kHint };

struct ControlRequest {
  ControlCommand command = ControlCommand::kStatus;
  PoseHint hint;  ///< of kHint, valid
};

/// One line without its line feed: "status", "reload", "reset" or "hint X Y Z YAW_DEG RADIUS_M", all in the map. A carriage return
/// and blanks around it are forgiven. kInvalid otherwise, with the list of commands or what a hint lacks; the message quotes the
/// bytes as they came.
[[nodiscard]] Result<ControlRequest> parse_control_request(std::string_view line);

/// {"ok":true} / {"ok":false,"error":"..."}, without a line feed.
[[nodiscard]] std::string control_reply(const Status& status);
/// {"ok":true,"state":"LOCALIZED",...}: every field under the name it has in status_t, and of the coarse worker what status_t, which
/// is never edited, does not have; map_id as text in hexadecimal, because
/// JSON numbers lose the low bits of 64-bit integers.
[[nodiscard]] std::string control_reply(const DaemonStatus& status);

}  // namespace camloc
