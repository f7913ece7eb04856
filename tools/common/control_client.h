// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The other end of camlocd's control socket: one line out, one line of JSON back.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/result.h"

namespace camloc::tools {

inline constexpr const char* kDefaultControlSocket = "/run/camloc/control.sock";

/// Sends `command` and waits for the answer, a JSON object whose keys keep their order. kUnavailable: nobody listens; kIo:
/// not permitted; kTimeout; kCorrupt: the answer is not a JSON object. An answer with "ok": false is a result, no error.
[[nodiscard]] Result<nlohmann::ordered_json> control_request(const std::string& socket_path, const std::string& command,
                                                             std::chrono::milliseconds timeout);

}  // namespace camloc::tools
