// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Prints the frame sources of this build, "scheme<tab>help" a line, for manual pages and shell completion.
#include <cstdio>

#include "drivers/sources.h"

int main() {
  for (const camloc::SourceEntry& source : camloc::frame_sources()) std::printf("%s\t%s\n", source.scheme, source.help);
  return 0;
}
