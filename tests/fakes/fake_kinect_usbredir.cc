// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// fake-kinect-usbredir: a Kinect V1 for a virtual machine, through QEMU's usb-redir. The guest has a real USB stack and real drivers.
//
//   fake-kinect-usbredir --socket kinect.sock [options] &
//   qemu-system-x86_64 ... -device usb-ehci,id=ehci
//       -chardev socket,id=kinect,path=kinect.sock -device usb-redir,chardev=kinect,bus=ehci.0
//
// It waits for QEMU at the socket, serves it, and waits for the next one; `--once` ends with the first. The EHCI controller it must
// be: QEMU's xHCI loses isochronous packets of redirected devices. The motor is another device: another process with
// --device motor, another chardev. Steered as fake-kinect is:
//   fake-kinect-usbredir --socket kinect.sock --control k.sock ... ; echo unplug | nc -NU k.sock ; echo replug | nc -NU k.sock
// Ends on SIGTERM. Emulated guests are slow: no performance is measured here.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>

#include "tests/fakes/rig_arguments.h"
#include "tests/fakes/unix_listener.h"
#include "tests/fakes/usbredir_device.h"

namespace {

using namespace camloc;
using namespace camloc::fakes;

constexpr int kFailed = 1, kUsage = 2;
constexpr int kStreamingPollMs = 1, kIdlePollMs = 20;

volatile sig_atomic_t is_ending = 0;
void on_signal(int /*signal*/) { is_ending = 1; }

int fail(const Status& status, int code) {
  std::fprintf(stderr, "fake-kinect-usbredir: %s\n", status.message().c_str());
  return code;
}

std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The rig, and the peer that it is shown to, under one lock.
struct Server {
  std::mutex mutex;
  KinectRig* rig = nullptr;
  UsbDeviceId id = UsbDeviceId::kCamera;
  std::unique_ptr<UsbredirDevice> device;  ///< while somebody is connected
  bool is_plugged = true;
  std::int64_t origin_ns = monotonic_ns();

  [[nodiscard]] std::int64_t now_ns() const { return monotonic_ns() - origin_ns; }
  [[nodiscard]] std::string command(const std::string& line);
  [[nodiscard]] bool serve_once(int listener);
};

std::string Server::command(const std::string& line) {
  const std::lock_guard lock(mutex);
  if (line != "unplug" && line != "replug") return rig->command(line, now_ns());
  if (is_plugged == (line == "replug")) return "error: the Kinect is " + std::string(is_plugged ? "" : "not ") + "plugged in";
  is_plugged = !is_plugged;
  if (device) device->plug(is_plugged, now_ns());
  return "ok";
}

/// Waits for something to do, at most until the next packets are due, and does it. False when a peer left.
bool Server::serve_once(int listener) {
  pollfd wait{device ? device->fd() : listener, POLLIN, 0};
  if (device && device->has_output()) wait.events |= POLLOUT;
  ::poll(&wait, 1, device && device->is_streaming() ? kStreamingPollMs : kIdlePollMs);
  const std::lock_guard lock(mutex);
  if (!device) {
    UniqueFd peer(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!peer.is_open()) return true;
    constexpr int kSendBuffer = 4 << 20;
    ::setsockopt(peer.get(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
    device = std::make_unique<UsbredirDevice>(rig, id, std::move(peer), is_plugged);
    return true;
  }
  bool is_alive = (wait.revents & (POLLIN | POLLHUP)) == 0 || device->read(now_ns());
  device->advance(now_ns());
  if (is_alive && device->has_output()) is_alive = device->write();
  if (!is_alive) {
    device.reset();
    rig->power_cycle(now_ns());
  }
  return is_alive;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A Kinect V1 for a virtual machine, through QEMU's usb-redir.", "fake-kinect-usbredir");
  RigArguments arguments;
  add_rig_options(&app, &arguments);
  std::string socket_path, device = "camera";
  bool is_once = false, is_unplugged = false;
  app.add_option("--socket", socket_path, "UNIX socket to which QEMU connects")->required();
  app.add_option("--device", device, "camera or motor")->check(CLI::IsMember({"camera", "motor"}))->capture_default_str();
  app.add_flag("--once", is_once, "End when the first peer leaves");
  app.add_flag("--unplugged", is_unplugged, "Start without the device");
  CLI11_PARSE(app, argc, argv);
  if (const Status status = finish(&arguments); !status) return fail(status, kUsage);

  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGTERM, SIGINT}) ::sigaction(signal, &action, nullptr);
  auto rig = KinectRig::create(arguments.rig);
  if (!rig) return fail(rig.status(), kFailed);
  const auto listener = listen_at(socket_path, 1, SOCK_NONBLOCK);
  if (!listener) return fail(listener.status(), kFailed);

  Server server;
  server.rig = rig->get();
  server.id = device == "motor" ? UsbDeviceId::kMotor : UsbDeviceId::kCamera;
  server.is_plugged = !is_unplugged;
  (*rig)->set_monotonic_offset(server.origin_ns);
  (*rig)->set_extra_counts(
      [&] { return "\"usbredir\": {\"overflowed\": " + std::to_string(server.device ? server.device->num_overflowed() : 0) + "}"; });
  auto control =
      ControlServer::start(arguments.control_socket, arguments.schedule, [&](const std::string& line) { return server.command(line); });
  if (!control) return fail(control.status(), kFailed);
  while (is_ending == 0) {
    if (!server.serve_once(listener->get()) && is_once) break;
  }
  control->reset();
  if (arguments.counts_file.empty()) return 0;
  const Status status = write_counts(arguments.counts_file, server.command("counts"));
  return status ? 0 : fail(status, kFailed);
}
