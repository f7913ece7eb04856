// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-map/commands.h"

#include "tools/common/command_line.h"

namespace camloc::mapping {

int report_error(const Status& status, int exit_code) {
  tools::print_error("camloc-map", status.message());
  return exit_code;
}

}  // namespace camloc::mapping
