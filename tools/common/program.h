// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Other programs: where they are, running them. `camloc X` runs `camloc-X` this way, as git does.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace camloc::tools {

/// Path of an installed program: beside this one, in ../NAME/ beside it (a build tree), then in PATH. kNotFound otherwise.
[[nodiscard]] Result<std::string> find_program(const std::string& name);

/// Replaces this process. Returns only when that failed.
[[nodiscard]] Status exec_program(const std::string& path, const std::vector<std::string>& arguments);

struct ProgramOutput {
  int exit_code = 0;  ///< 128 + signal where it was killed
  std::string out;    ///< stdout
  std::string err;    ///< stderr
};

/// Runs a program to its end with no input. kTimeout: it was killed.
[[nodiscard]] Result<ProgramOutput> run_program(const std::string& path, const std::vector<std::string>& arguments,
                                                std::chrono::milliseconds timeout);

/// The candidate closest to `word` in edits, empty when none is close.
[[nodiscard]] std::string closest_word(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace camloc::tools
