// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs one sub-command of camloc in this process and keeps what it printed. And a folder that vanishes with the test.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace camloc::tools {

struct CommandOutput {
  int exit_code = 0;
  std::string out, err;
};

/// `arguments` as after "camloc". A usage error gives exit code 2, as main does.
CommandOutput run_command(void (*add)(CLI::App&, int&), std::vector<std::string> arguments);

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "camloc-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data()) != nullptr ? name : "";
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Writes a file; with `is_program` one that can be run.
  [[nodiscard]] std::string write(const std::string& name, const std::string& content, bool is_program = false) const {
    const std::string path = *this / name;
    std::ofstream(path) << content;
    if (is_program) std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

 private:
  std::string path_;
};

}  // namespace camloc::tools
