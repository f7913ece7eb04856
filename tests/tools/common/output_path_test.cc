// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/output_path.h"

#include <gtest/gtest.h>

#include "tests/tools/command_runner.h"

namespace camloc::tools {
namespace {

TEST(OutputPathTest, AFileInAFolderThatIsThere) {
  const TemporaryFolder folder;
  EXPECT_TRUE(check_output_path("--out", folder / "new.cmap").is_ok());
  EXPECT_TRUE(check_output_path("--out", folder.write("old.cmap", "x")).is_ok()) << "an old file may be replaced";
  EXPECT_TRUE(check_output_path("--out", "here.cmap").is_ok());
  for (const std::string& path : {std::string(), folder.path(), folder / "no/such/x", folder / "old.cmap/x"}) {
    const Status status = check_output_path("--out", path);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << path;
    EXPECT_NE(status.message().find("--out"), std::string::npos) << status.message();
  }
}

}  // namespace
}  // namespace camloc::tools
