// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/output_path.h"

#include <filesystem>
#include <system_error>

namespace camloc::tools {

Status check_output_path(const std::string& option, const std::string& path) {
  std::error_code ignored;
  if (path.empty()) return {ErrorCode::kInvalid, option + ": is empty; give a file name"};
  if (std::filesystem::is_directory(path, ignored)) return {ErrorCode::kInvalid, option + " " + path + ": is a folder; give a file name"};
  const auto folder = std::filesystem::path(path).parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return Status::ok();
  return {ErrorCode::kInvalid, option + " " + path + ": folder " + folder.string() + " does not exist; make it first"};
}

}  // namespace camloc::tools
