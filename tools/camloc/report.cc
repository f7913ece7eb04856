// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How the programs say that something went wrong: one line on stderr and an exit code.
#include "tools/camloc/commands.h"
#include "tools/common/command_line.h"

namespace camloc::tools {

int report(const Status& status) {
  if (status.is_ok()) return 0;
  print_error("camloc", status.message());
  return status.code() == ErrorCode::kInvalid ? 2 : 1;
}

}  // namespace camloc::tools
