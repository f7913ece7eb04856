// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <sstream>

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

/// Both ends of a pipe, closed on exec; not open when the system refused.
struct Pipe {
  UniqueFd read_end, write_end;

  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
    read_end.reset(ends[0]);
    write_end.reset(ends[1]);
  }
};

[[noreturn]] void become(const std::string& path, const std::vector<char*>& pointers, const Pipe& out, const Pipe& err) {
  const int null = ::open("/dev/null", O_RDONLY);
  ::dup2(null, STDIN_FILENO);
  ::dup2(out.write_end.get(), STDOUT_FILENO);
  ::dup2(err.write_end.get(), STDERR_FILENO);
  ::execv(path.c_str(), pointers.data());
  ::_exit(127);
}

/// Reads both pipes until they are closed. False when the time is up.
bool drain(Pipe* out, Pipe* err, ProgramOutput* output, std::chrono::steady_clock::time_point deadline) {
  while (out->read_end.is_open() || err->read_end.is_open()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    std::array<pollfd, 2> fds{pollfd{out->read_end.get(), POLLIN, 0}, pollfd{err->read_end.get(), POLLIN, 0}};
    if (::poll(fds.data(), fds.size(), static_cast<int>(left)) < 0 && errno != EINTR) return false;
    for (std::size_t i = 0; i < fds.size(); ++i) {
      if (fds[i].fd < 0 || fds[i].revents == 0) continue;
      std::array<char, 4096> bytes{};
      const ssize_t count = ::read(fds[i].fd, bytes.data(), bytes.size());
      if (count > 0) (i == 0 ? output->out : output->err).append(bytes.data(), static_cast<std::size_t>(count));
      if (count == 0 || (count < 0 && errno != EINTR)) (i == 0 ? out : err)->read_end.reset();
    }
  }
  return true;
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
  Pipe out;
  Pipe err;
  if (!out.read_end.is_open() || !err.read_end.is_open()) return system_error("cannot make a pipe");
  const auto pointers = argument_pointers(path, arguments);
  const pid_t child = ::fork();
  if (child < 0) return system_error("cannot fork");
  if (child == 0) become(path, pointers, out, err);
  out.write_end.reset();
  err.write_end.reset();

  ProgramOutput output;
  const bool is_done = drain(&out, &err, &output, std::chrono::steady_clock::now() + timeout);
  if (!is_done) ::kill(child, SIGKILL);
  int wait_status = 0;
  while (::waitpid(child, &wait_status, 0) < 0 && errno == EINTR) {}
  if (!is_done) return {ErrorCode::kTimeout, path + " did not finish within " + std::to_string(timeout.count()) + " ms"};
  output.exit_code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 128 + WTERMSIG(wait_status);
  return output;
}

std::string closest_word(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace camloc::tools
