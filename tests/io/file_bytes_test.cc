// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.h"

#include <sys/stat.h>

#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

TEST(FileBytes, ReadsWholeFilesAndReusesTheBuffer) {
  const TestFolder folder;
  const std::string path = folder.write("a", std::string("x\0y\n", 4));
  EXPECT_EQ(*read_file_text(path), std::string("x\0y\n", 4));
  std::vector<std::uint8_t> bytes(1000);
  const std::uint8_t* buffer = bytes.data();
  ASSERT_TRUE(read_file_bytes(path, 100, &bytes).is_ok());
  EXPECT_EQ(bytes.size(), 4U);
  EXPECT_EQ(bytes.data(), buffer);
  EXPECT_EQ(read_file_text(folder.write("empty", "")).value(), "");
}

TEST(FileBytes, ErrorsNameTheFile) {
  const TestFolder folder;
  const std::string path = folder.write("a", "12345");
  ::mkfifo((folder / "pipe").c_str(), 0600);
  const struct {
    std::string path;
    ErrorCode code;
  } cases[] = {
      {folder / "none", ErrorCode::kNotFound}, {path + "/b", ErrorCode::kNotFound}, {folder.path(), ErrorCode::kInvalid},
      {folder / "pipe", ErrorCode::kInvalid},  {path, ErrorCode::kInvalid},
  };
  for (const auto& one : cases) {
    const auto result = read_file_text(one.path, 4);
    EXPECT_EQ(result.status().code(), one.code) << result.status().message();
    EXPECT_TRUE(result.status().message().starts_with(one.path + ": ")) << result.status().message();
  }
}

}  // namespace
}  // namespace camloc
