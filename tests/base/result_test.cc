// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors as values.
#include "core/base/result.h"

#include <gtest/gtest.h>

#include <memory>

namespace camloc {
namespace {

TEST(Status, IsOkByDefault) {
  const Status status;
  EXPECT_TRUE(status.is_ok());
  EXPECT_TRUE(static_cast<bool>(status));
  EXPECT_EQ(status.code(), ErrorCode::kOk);
  EXPECT_EQ(status.message(), "");
  EXPECT_TRUE(Status::ok().is_ok());
}

TEST(Status, KeepsCodeAndMessage) {
  const Status status(ErrorCode::kNotFound, "no such map");
  EXPECT_FALSE(status.is_ok());
  EXPECT_FALSE(static_cast<bool>(status));
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_EQ(status.message(), "no such map");
}

TEST(Status, ContextGoesInFrontAndKeepsTheCode) {
  const Status status = Status(ErrorCode::kCorrupt, "checksum differs").with_context("section 3").with_context("a.cmap");
  EXPECT_EQ(status.code(), ErrorCode::kCorrupt);
  EXPECT_EQ(status.message(), "a.cmap: section 3: checksum differs");
  EXPECT_TRUE(Status::ok().with_context("a.cmap").is_ok());
  EXPECT_EQ(Status::ok().with_context("a.cmap").message(), "");
}

TEST(Result, HoldsAValue) {
  Result<std::string> result(std::string("value"));
  ASSERT_TRUE(result.is_ok());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_TRUE(result.status().is_ok());
  EXPECT_EQ(*result, "value");
  EXPECT_EQ(result->size(), 5U);
  result.value() = "other";
  EXPECT_EQ(*result, "other");
}

TEST(Result, HoldsAnError) {
  const Result<int> result(ErrorCode::kIo, "disk full");
  EXPECT_FALSE(result.is_ok());
  EXPECT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.status().code(), ErrorCode::kIo);
  EXPECT_EQ(result.status().message(), "disk full");
  const Result<std::string> passed_on(result.status().with_context("map"));
  EXPECT_EQ(passed_on.status().message(), "map: disk full");
}

TEST(Result, MovesValuesThatCannotBeCopied) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(7));
  ASSERT_TRUE(result);
  const std::unique_ptr<int> taken = std::move(result).value();
  EXPECT_EQ(*taken, 7);
}

#ifndef NDEBUG
TEST(ResultDeathTest, ReadingTheValueOfAFailureIsOurOwnBug) {
  const Result<int> result(ErrorCode::kIo, "disk full");
  EXPECT_DEATH((void)result.value(), "");
}
#endif

}  // namespace
}  // namespace camloc
