// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/program.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <sstream>
#include <thread>

#include "core/base/unique_fd.h"

namespace camloc::tools {
namespace {

namespace fs = std::filesystem;

std::vector<char*> argument_pointers(const std::string& path, const std::vector<std::string>& arguments) {
  std::vector<char*> pointers{const_cast<char*>(path.c_str())};  // execv's signature predates const; it changes nothing
  for (const auto& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

bool is_executable_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

Status system_error(const std::string& what) { return {ErrorCode::kIo, what + ": " + std::strerror(errno)}; }

[[noreturn]] void become(const std::string& path, const std::vector<char*>& pointers, int out, int err) {
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execv(path.c_str(), pointers.data());
  ::_exit(127);
}

/// False when the time is up.
bool wait_for(pid_t child, std::chrono::milliseconds timeout, int* wait_status) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (::waitpid(child, wait_status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// All that was written to a file without a name.
std::string text_in(int fd) {
  std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(fd, 0, SEEK_END), 0)), '\0');
  const ssize_t count = ::pread(fd, text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

Result<std::string> find_program(const std::string& name) {
  std::vector<fs::path> folders;
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    folders.push_back(self.parent_path());
    folders.push_back(self.parent_path().parent_path() / name);                    // build/tools/camloc -> build/tools/camloc-map
    folders.push_back(self.parent_path().parent_path().parent_path() / "daemon");  // build/tools/camloc -> build/daemon
  }
  const char* path_variable = std::getenv("PATH");
  std::istringstream entries(path_variable == nullptr ? "" : path_variable);
  for (std::string entry; std::getline(entries, entry, ':');) folders.emplace_back(entry.empty() ? "." : entry);
  for (const auto& folder : folders) {
    if (is_executable_file(folder / name)) return (folder / name).string();
  }
  return {ErrorCode::kNotFound, "program '" + name + "' is neither beside camloc nor in PATH"};
}

Status exec_program(const std::string& path, const std::vector<std::string>& arguments) {
  ::execv(path.c_str(), argument_pointers(path, arguments).data());
  return system_error("cannot run " + path);
}

Result<ProgramOutput> run_program(const std::string& path, const std::vector<std::string>& arguments, std::chrono::milliseconds timeout) {
  const UniqueFd out(::memfd_create("stdout", MFD_CLOEXEC)), err(::memfd_create("stderr", MFD_CLOEXEC));
  if (!out.is_open() || !err.is_open()) return system_error("cannot keep what a program says");
  const auto pointers = argument_pointers(path, arguments);
  const pid_t child = ::fork();
  if (child < 0) return system_error("cannot fork");
  if (child == 0) become(path, pointers, out.get(), err.get());

  int wait_status = 0;
  if (!wait_for(child, timeout, &wait_status)) {
    ::kill(child, SIGKILL);
    while (::waitpid(child, &wait_status, 0) < 0 && errno == EINTR) {}
    return {ErrorCode::kTimeout, path + " did not finish within " + std::to_string(timeout.count()) + " ms"};
  }
  const int exit_code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
  return ProgramOutput{exit_code, text_in(out.get()), text_in(err.get())};
}

std::string closest_word(const std::string& word, const std::vector<std::string>& candidates) {
  const auto is_closer = [&](const std::string& a, const std::string& b) { return edit_distance(word, a) < edit_distance(word, b); };
  const auto best = std::min_element(candidates.begin(), candidates.end(), is_closer);
  const std::size_t most = std::max<std::size_t>(2, word.size() / 3);
  return best == candidates.end() || edit_distance(word, *best) > most ? "" : *best;
}

}  // namespace camloc::tools
