// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The interposed allocator of the geometry tests, in this test program, too.
#include "tests/geometry/allocation_counter.cc"
