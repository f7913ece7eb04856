// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as request: a command or an error, and the reply is one line of printable ASCII. A hint, also one over LCM, is valid
// or refused.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/control_protocol.h"
#include "daemon/hint_listener.h"

constexpr std::int64_t kNow_ns = 1'800'000'000'000'000'000;  // of corpus/control/hint_message

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  const camloc::Result<camloc::ControlRequest> command = camloc::parse_control_request(line);
  camloc::DaemonStatus status;
  status.state_text = line;
  for (const std::string& reply : {camloc::control_reply(command.status()), camloc::control_reply(status)}) {
    const bool is_printable = std::all_of(reply.begin(), reply.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
    if (!is_printable || reply.front() != '{' || reply.back() != '}') std::abort();
  }
  if (command && command->command == camloc::ControlCommand::kHint && !command->hint.is_valid()) std::abort();
  const camloc::Result<camloc::PoseHint> hint = camloc::parse_hint_message({data, size}, kNow_ns);
  if (hint && !hint->is_valid()) std::abort();
  return 0;
}
