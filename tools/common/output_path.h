// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether a result can be written where the user wants it, asked before the work is done.
#pragma once

#include <string>

#include "core/base/result.h"

namespace camloc::tools {

/// kInvalid where `path` is empty, a folder, or in a folder that does not exist; `option` is named in the message.
[[nodiscard]] Status check_output_path(const std::string& option, const std::string& path);

}  // namespace camloc::tools
