// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Prints the frame sources of this build, "scheme<tab>help" a line, for manual pages and shell completion.
#include <cstdio>

#include "drivers/frame_source.h"

int main() {
  for (const auto& scheme : camloc::frame_source_schemes()) std::printf("%s\t%s\n", scheme.scheme.c_str(), scheme.help.c_str());
  return 0;
}
