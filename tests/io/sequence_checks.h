// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings made of empty files, and what is expected of those that cannot be read.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "core/io/sequence.h"
#include "tests/drivers/test_folder.h"

namespace camloc {

inline void expect_error(const Result<Sequence>& result, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(result.is_ok());
  EXPECT_EQ(result.status().code(), code) << result.status().message();
  EXPECT_NE(result.status().message().find(part), std::string::npos) << result.status().message();
}

/// Image files are only looked for, not opened.
inline void touch(const TestFolder& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) folder.write(name, "x");
}

}  // namespace camloc
