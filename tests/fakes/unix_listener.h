// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A UNIX stream socket that waits for connections, as the fakes offer them.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/base/unique_fd.h"

namespace camloc::fakes {

/// Takes the place of a file of that name. `flags` are added to those of socket(2), e.g. SOCK_NONBLOCK. Errors: kInvalid, a name
/// too long for a socket; kIo.
[[nodiscard]] Result<UniqueFd> listen_at(const std::string& path, int backlog, int flags = 0);

}  // namespace camloc::fakes
