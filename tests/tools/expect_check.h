// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a check of `camloc doctor` says and advises.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {

inline void expect(const Check& check, Level level, const std::string& detail, const std::string& advice = "") {
  EXPECT_EQ(check.level, level) << check.name << ": " << check.detail;
  EXPECT_NE(check.detail.find(detail), std::string::npos) << check.name << ": " << check.detail;
  EXPECT_NE(check.advice.find(advice), std::string::npos) << check.name << ": " << check.advice;
  EXPECT_EQ(check.advice.empty(), level == Level::kOk) << check.name << ": " << check.advice;
  EXPECT_EQ((check.detail + check.advice).find('\n'), std::string::npos);
}

}  // namespace camloc::tools
