// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the daemon says on stderr may be read by nobody, or by somebody who stops reading. Neither may stop the daemon.
#pragma once

#include <string_view>

namespace camloc {

/// For the start of main(), before anything is opened. Ignores SIGPIPE, and SIGXFSZ (a log file at its limit of size). Descriptors 0 to 2
/// that are closed become /dev/null, so that no file or socket is opened in their place and written to. Where stderr is a pipe, a terminal
/// or the journal's socket, it is made non-blocking, for libraries that print, too: as an open file of our own, so that who shares it (a
/// shell) notices nothing.
void guard_standard_streams();

/// Writes all of `line`, of at most 4096 bytes, at once or not at all, and does not wait for a reader. False when it is lost, or a part
/// of it. Where `fd` is a pipe that others write to at the same moment, only a non-blocking one never waits.
[[nodiscard]] bool write_without_waiting(int fd, std::string_view line);

}  // namespace camloc
