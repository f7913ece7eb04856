// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The service, the network, the clock and the machine.
#include <sys/timex.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <map>
#include <sstream>

#include "core/features/hamming.h"
#include "tools/common/text_format.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

constexpr std::uint64_t kMinMemoryKb = 65536;        // camlocd needs half of that with a map of one building
constexpr std::int64_t kEarliest_s = 1'767'225'600;  // 2026-01-01: camloc is not older
constexpr const char* kJournal = "'journalctl -u camlocd -b -n 50' has the reason";

std::map<std::string, std::string> parse_properties(const std::string& text) {
  std::map<std::string, std::string> properties;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const std::size_t equals = line.find('='); equals != std::string::npos)
      properties[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return properties;
}

}  // namespace

Check check_daemon(const std::string& socket_path, DaemonAnswer* daemon) {
  auto answer = control_request(socket_path, "status", std::chrono::seconds(3));
  if (answer) {
    *daemon = *answer;
    return {"daemon", Level::kOk, socket_path + ": " + answer->value("state", std::string("answers")), ""};
  }
  const bool is_absent = answer.status().code() == ErrorCode::kUnavailable;
  return {"daemon", is_absent ? Level::kWarning : Level::kFailure, answer.status().message(),
          is_absent ? "" : "'journalctl -u camlocd' has the reason"};
}

Check check_service(const std::string& text) {
  auto properties = parse_properties(text);
  const std::string active = properties["ActiveState"], sub = properties["SubState"], result = properties["Result"];
  if (active.empty()) return {"service", Level::kWarning, "systemctl does not know camlocd", "is systemd running?"};
  if (properties["LoadState"] == "not-found")
    return {"service", Level::kWarning, "camlocd.service is not installed", "sudo apt install ./camloc_*.deb"};
  if (properties["LoadState"] == "masked")
    return {"service", Level::kWarning, "camlocd.service is masked", "sudo systemctl unmask camlocd"};
  if (active == "failed" || sub == "auto-restart") {
    const std::string why =
        result == "watchdog" ? "frames made no progress and the watchdog ended it" : "it ended with result '" + result + "'";
    return {"service", Level::kFailure, "camlocd.service: " + why, std::string(kJournal) + "; then sudo systemctl restart camlocd"};
  }
  if (active == "activating") return {"service", Level::kWarning, "camlocd.service is starting", kJournal};
  if (active != "active") {
    const bool is_enabled = properties["UnitFileState"] == "enabled";
    return {"service", Level::kWarning, "camlocd.service is " + active + (is_enabled ? "" : " and not enabled"),
            is_enabled ? "sudo systemctl start camlocd" : "sudo systemctl enable --now camlocd"};
  }
  const std::string restarts = properties["NRestarts"];
  if (!restarts.empty() && restarts != "0")
    return {"service", Level::kWarning, "camlocd.service is active, after " + restarts + " restarts", kJournal};
  return {"service", Level::kOk, "camlocd.service is active", ""};
}

Check check_lcm(const std::string& url) {
  const auto route = find_multicast_route(url);
  if (!route && route.status().code() == ErrorCode::kInvalid)
    return {"lcm", Level::kFailure, route.status().message(), "set publish.lcm_url"};
  if (!route) return {"lcm", Level::kFailure, route.status().message(), "sudo systemctl enable --now camloc-multicast"};
  if (route->group.empty()) return {"lcm", Level::kOk, url + ": no network", ""};
  const bool is_local = route->local_address.rfind("127.", 0) == 0;
  const std::string detail = url + ": leaves by " + route->local_address;
  if (!is_local && route->ttl == 0) return {"lcm", Level::kOk, detail + ", ttl=0 keeps it on this machine", ""};
  if (!is_local)
    return {"lcm", Level::kWarning, detail + " with ttl=" + std::to_string(route->ttl),
            "poses leave this machine; set ttl=0 unless you want that"};
  return {"lcm", Level::kOk, detail, ""};
}

ClockState read_clock() {
  timex state{};
  const int mode = ::adjtimex(&state);
  return {static_cast<std::int64_t>(std::time(nullptr)), mode >= 0 && (state.status & STA_UNSYNC) == 0};
}

Check check_clock(const ClockState& clock) {
  const auto seconds = static_cast<std::time_t>(clock.epoch_s);
  std::tm date{};
  char text[32] = "?";
  if (::gmtime_r(&seconds, &date) != nullptr) std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &date);
  if (clock.epoch_s < kEarliest_s) {
    return {"clock", Level::kFailure, std::string("says ") + text + ": poses get stamps of the past",
            "sudo timedatectl set-ntp true, or sudo date -s 'YYYY-MM-DD HH:MM:SS'"};
  }
  if (clock.is_synchronized) return {"clock", Level::kOk, std::string(text) + ", synchronized", ""};
  return {"clock", Level::kWarning, std::string(text) + ", not synchronized: stamps cannot be compared with those of other machines",
          "sudo timedatectl set-ntp true"};
}

Check check_cpu() {
  const std::string kernel = hamming_kernel_name(), detail = "descriptor matching with " + kernel;
  if (kernel == "scalar")
    return {"cpu", Level::kWarning, detail, "expect a lower frame rate; in a virtual machine pass the host's CPU through"};
  return {"cpu", Level::kOk, detail, ""};
}

Check check_memory(const SystemFolders& folders) {
  std::ifstream file(folders.path("/proc/meminfo"));
  std::string key;
  for (std::uint64_t kilobytes = 0; file >> key >> kilobytes; file.ignore(100, '\n')) {
    if (key != "MemAvailable:") continue;
    const std::string detail = std::to_string(kilobytes / 1024) + " MiB available";
    if (kilobytes < kMinMemoryKb) return {"memory", Level::kWarning, detail, "camlocd needs about 32 MiB and the map"};
    return {"memory", Level::kOk, detail, ""};
  }
  return {"memory", Level::kWarning, "/proc/meminfo does not say", ""};
}

}  // namespace camloc::tools
