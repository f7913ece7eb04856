// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/interrupt.h"

#include <gtest/gtest.h>

namespace camloc::tools {
namespace {

TEST(InterruptGuardTest, ASignalSetsTheFlagAndANewGuardForgetsIt) {
  {
    const InterruptGuard guard;
    EXPECT_FALSE(InterruptGuard::is_interrupted());
    std::raise(SIGTERM);
    EXPECT_TRUE(InterruptGuard::is_interrupted());
  }
  const InterruptGuard guard;
  EXPECT_FALSE(InterruptGuard::is_interrupted());
}

}  // namespace
}  // namespace camloc::tools
