// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A UNIX socket on which a running test sends command lines and reads an answer line for each, and a schedule of command lines by time.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/result.h"
#include "core/base/unique_fd.h"

namespace camloc::fakes {

struct TimedCommand {
  double at_s = 0;  ///< after start
  std::string line;
};
/// "SECONDS:COMMAND".
[[nodiscard]] Result<TimedCommand> parse_timed_command(const std::string& text);

class ControlServer {
 public:
  using Handler = std::function<std::string(const std::string& line)>;
  /// `handler` is called from a thread of the server. Without a path only the schedule is run; errors of its commands go to stderr.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> start(const std::string& path, std::vector<TimedCommand> schedule,
                                                                    Handler handler);
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

 private:
  ControlServer() = default;
  void run();
  void serve(int fd);
  void run_due_commands();

  std::string path_;
  std::vector<TimedCommand> schedule_;  ///< ascending in time
  Handler handler_;
  UniqueFd listener_;
  std::int64_t start_ns_ = 0;
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace camloc::fakes
