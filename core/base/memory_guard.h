// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a program does when memory or threads are exhausted: nothing that it holds can be repaired then, in whichever thread it happens. It
// says its last line and ends with exit code 1; files are replaced whole or not at all, so nothing is lost.
#pragma once

namespace camloc {

/// For main(), once. `last_words` is one line with its end, and outlives the program. Covers what nobody catches, in every thread:
/// operator new, Eigen, std::thread; whoever can do without what it asked for still may. Other uncaught exceptions abort as ever.
void install_memory_guard(const char* last_words);

}  // namespace camloc
