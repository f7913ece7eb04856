// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes the map that the scenario tests localize sample:// in. Usage: make_sample_map FILE [NUM_FRAMES]
#include <cstdio>
#include <cstdlib>

#include "tests/daemon/sample_map.h"

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  camloc::testing::SampleMapOptions options;
  options.num_frames = camloc::kSamplePeriod;  // all around, so that a daemon is never outside the map
  options.step = 10;
  if (argc > 2) options.num_frames = std::strtoull(argv[2], nullptr, 10);
  const camloc::Status status = camloc::testing::write_sample_map(options, argv[1]);
  if (!status) std::fprintf(stderr, "make_sample_map: %s\n", status.message().c_str());
  return status ? 0 : 1;
}
