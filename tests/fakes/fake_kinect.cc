// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// fake-kinect: a Kinect V1 for programs on this host, through umockdev. Real libusb, real device files as far as they can tell.
//
//   umockdev-wrapper fake-kinect [options] -- PROGRAM ARGS...    runs PROGRAM with the Kinect plugged in, exits with its code
//   umockdev-wrapper fake-kinect [options]                       prints UMOCKDEV_DIR=..., stays until SIGTERM; programs that are started
//                                                                with that variable under umockdev-wrapper see the Kinect
//   e.g. umockdev-wrapper fake-kinect --folder kitchen --control k.sock -- camlocd --set 'camera.source="kinect://"'
//        echo unplug | nc -NU k.sock ; echo replug | nc -NU k.sock ; echo counts | nc -NU k.sock
//
// Clients may come one after another and be killed; each finds the device as the last one left it. The fake must be allowed to
// read their memory (same user; it is their parent, or kernel.yama.ptrace_scope is 0). Programs built with AddressSanitizer need
// ASAN_OPTIONS=verify_asan_link_order=0, as umockdev comes first. Always run under `timeout -k`.
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <umockdev.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/fakes/rig_arguments.h"
#include "tests/fakes/umockdev_bus.h"

namespace {

using namespace camloc;
using namespace camloc::fakes;

constexpr int kFailed = 1, kUsage = 2;

int fail(const Status& status, int code) {
  std::fprintf(stderr, "fake-kinect: %s\n", status.message().c_str());
  return code;
}

/// Starts `command` with signals as they were before; it ends with this process. 0 on failure.
pid_t start(const std::vector<std::string>& command, const sigset_t& mask, int old_nice) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid != 0) return pid < 0 ? 0 : pid;
  ::setpriority(PRIO_PROCESS, 0, old_nice);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  ::sigprocmask(SIG_SETMASK, &mask, nullptr);
  ::execvp(arguments[0], arguments.data());
  std::fprintf(stderr, "fake-kinect: %s: %s\n", arguments[0], std::strerror(errno));
  ::_exit(127);
}

/// Waits for the program's end, handing signals on to it; without one, for a signal.
int wait_for_end(pid_t pid, const sigset_t& signals) {
  for (;;) {
    int signal = 0;
    ::sigwait(&signals, &signal);
    if (signal != SIGCHLD) {
      if (pid == 0) return 0;
      ::kill(pid, signal);
      continue;
    }
    int state = 0;
    if (pid != 0 && ::waitpid(pid, &state, WNOHANG) == pid) return WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
  }
}

std::string with_cpu_time(const std::string& counts) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const long ms = (usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1000 + (usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) / 1000;
  return counts.substr(0, counts.size() - 1) + ", \"cpu_ms\": " + std::to_string(ms) + "}";
}

std::string run_command(const std::string& line, UsbfsHost* host, UmockdevBus* bus) {
  if (line == "unplug" || line == "replug") {
    const Status status = line == "unplug" ? bus->unplug() : bus->replug();
    return status ? "ok" : "error: " + status.message();
  }
  const std::string answer = host->command(line);
  return answer.starts_with("{") ? with_cpu_time(answer) : answer;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A Kinect V1 for programs on this host, through umockdev. Run under umockdev-wrapper.", "fake-kinect");
  RigArguments arguments;
  add_rig_options(&app, &arguments);
  bool is_real_time = false, has_driver = false, is_unplugged = false, has_no_motor = false;
  std::vector<std::string> command;
  app.add_flag("--real-time", is_real_time, "Lose packets when the client is late with its buffers, as a real bus does");
  app.add_flag("--kernel-driver", has_driver, "gspca_kinect owns the camera until it is detached");
  app.add_flag("--unplugged", is_unplugged, "Start without the device");
  app.add_flag("--no-motor", has_no_motor, "Only the camera (always so with --model 1473 and k4w)");
  app.add_option("command", command, "-- PROGRAM ARGS...");
  app.positionals_at_end();
  CLI11_PARSE(app, argc, argv);
  if (const Status status = finish(&arguments); !status) return fail(status, kUsage);

  sigset_t signals, old_signals;
  ::sigemptyset(&signals);
  for (const int signal : {SIGCHLD, SIGTERM, SIGINT, SIGHUP}) ::sigaddset(&signals, signal);
  ::sigprocmask(SIG_BLOCK, &signals, &old_signals);

  // A device does not wait for the scheduler of a loaded host: where it may, the fake goes before other programs. Threads inherit it.
  constexpr int kDeviceNice = -15;
  const int old_nice = ::getpriority(PRIO_PROCESS, 0);
  ::setpriority(PRIO_PROCESS, 0, kDeviceNice);

  auto rig = KinectRig::create(arguments.rig);
  if (!rig) return fail(rig.status(), kFailed);
  UsbfsHost host(rig->get(), is_real_time ? BusPace::kRealTime : BusPace::kLossless, has_driver);
  const bool has_motor = !has_no_motor && arguments.rig.kinect.model == KinectModel::k1414;  // later models have it in the audio device
  auto bus = UmockdevBus::create(rig->get(), &host, has_motor);
  if (!bus) return fail(bus.status(), kFailed);
  if (!is_unplugged) {
    if (const Status status = (*bus)->replug(); !status) return fail(status, kFailed);
  }
  const auto handler = [&](const std::string& line) { return run_command(line, &host, bus->get()); };
  auto control = ControlServer::start(arguments.control_socket, arguments.schedule, handler);
  if (!control) return fail(control.status(), kFailed);

  pid_t pid = 0;
  if (command.empty()) {
    std::printf("UMOCKDEV_DIR=%s\n", ::getenv("UMOCKDEV_DIR"));
    std::fflush(stdout);
  } else if (pid = start(command, old_signals, old_nice); pid == 0) {
    return fail({ErrorCode::kIo, command[0] + ": cannot start it"}, kFailed);
  }
  const int code = wait_for_end(pid, signals);
  control->reset();
  if (arguments.counts_file.empty()) return code;
  const Status status = write_counts(arguments.counts_file, with_cpu_time(host.command("counts")));
  return status ? code : fail(status, kFailed);
}
