// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc doctor`: what of an installation works, and what to do about the rest. Changes nothing.
#include <grp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/camloc/commands.h"
#include "tools/common/program.h"
#include "tools/common/text_format.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

struct DoctorOptions {
  std::string config_path = "/etc/camloc/camlocd.toml";
  std::optional<std::string> map_path, source_url, camera_path, lcm_url, socket_path;
  bool is_json = false;
};

const char* to_string(Level level) { return level == Level::kOk ? "ok" : level == Level::kWarning ? "warn" : "FAIL"; }

gid_t group_of_devices() {
  const group* plugdev = ::getgrnam("plugdev");
  return plugdev == nullptr ? static_cast<gid_t>(-1) : plugdev->gr_gid;
}

/// The kind of camera that is the source, and those of which something is on USB.
void examine_cameras(const Settings& settings, const DaemonAnswer& daemon, std::vector<Check>* checks) {
  const SystemFolders folders;
  const std::string scheme = settings.scheme();
  const std::vector<UsbDevice> devices = list_usb_devices(folders);
  for (const SourceEntry& source : frame_sources()) {
    const bool is_wanted = scheme == source.scheme;
    const auto is_of_source = [&](const UsbDevice& device) { return find_usb_source(device) == &source; };
    if (source.list != nullptr && (is_wanted || std::any_of(devices.begin(), devices.end(), is_of_source)))
      checks->push_back(check_presence(source, source.list(folders), is_wanted));
  }
  if (std::none_of(devices.begin(), devices.end(), [](const UsbDevice& device) { return is_usb_camera(device); })) return;
  checks->push_back(check_usb_rights(devices, folders, group_of_devices()));
  checks->push_back(check_usb_driver(devices, scheme, daemon.has_value()));
  checks->push_back(check_usb_bandwidth(devices, folders));
}

void examine_service(std::vector<Check>* checks) {
  std::error_code error;
  const auto systemctl = find_program("systemctl");
  if (!systemctl || !std::filesystem::is_directory("/run/systemd/system", error)) return;
  const auto shown =
      run_program(*systemctl, {"show", "camlocd.service", "--property=LoadState,ActiveState,SubState,Result,NRestarts,UnitFileState"},
                  std::chrono::seconds(5));
  if (shown) checks->push_back(check_service(shown->out));
}

std::vector<Check> examine(const DoctorOptions& options) {
  Settings settings;
  std::vector<Check> checks{check_config(options.config_path, &settings)};
  settings.map_path = options.map_path.value_or(settings.map_path);
  settings.source_url = options.source_url.value_or(settings.source_url);
  settings.camera_path = options.camera_path.value_or(settings.camera_path);
  settings.lcm_url = options.lcm_url.value_or(settings.lcm_url);
  settings.socket_path = options.socket_path.value_or(settings.socket_path);

  DaemonAnswer daemon;
  std::optional<ImageSize> size;
  examine_service(&checks);
  checks.push_back(check_daemon(settings.socket_path, &daemon));
  checks.push_back(check_map(settings.map_path));
  examine_cameras(settings, daemon, &checks);
  checks.push_back(check_source(settings.source_url, daemon, &size));
  checks.push_back(check_calibration(settings.camera_path, daemon, size));
  checks.push_back(check_lcm(settings.lcm_url));
  checks.push_back(check_clock(read_clock()));
  checks.push_back(check_cpu());
  checks.push_back(check_memory({}));
  return checks;
}

void print_text(const std::vector<Check>& checks) {
  for (const auto& check : checks) {
    std::printf("%-4s  %-12s %s\n", to_string(check.level), check.name.c_str(), printable(check.detail).c_str());
    if (!check.advice.empty()) std::printf("                   -> %s\n", printable(check.advice).c_str());
  }
}

void print_json(const std::vector<Check>& checks, bool is_ok) {
  nlohmann::json document{{"ok", is_ok}, {"checks", nlohmann::json::array()}};
  for (const auto& check : checks) {
    const char* level = check.level == Level::kFailure ? "fail" : to_string(check.level);
    document["checks"].push_back({{"name", check.name}, {"level", level}, {"detail", check.detail}, {"advice", check.advice}});
  }
  std::printf("%s\n", document.dump(2, ' ', true, nlohmann::json::error_handler_t::replace).c_str());
}

int run(const DoctorOptions& options) {
  const std::vector<Check> checks = examine(options);
  const bool is_ok = std::none_of(checks.begin(), checks.end(), [](const Check& check) { return check.level == Level::kFailure; });
  if (options.is_json) {
    print_json(checks, is_ok);
  } else {
    print_text(checks);
  }
  return is_ok ? 0 : 1;
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      app.add_subcommand("doctor", "Check configuration, service, map, camera, USB, network, clock, machine; say what to do");
  command->add_option("--config", options->config_path, "configuration of camlocd")->capture_default_str();
  command->add_option("--map", options->map_path, "instead of the configured map");
  command->add_option("--source", options->source_url, "instead of the configured frame source");
  command->add_option("--camera", options->camera_path, "instead of the configured camera file");
  command->add_option("--lcm-url", options->lcm_url, "instead of the configured LCM URL");
  command->add_option("--socket", options->socket_path, "instead of the configured control socket");
  command->add_flag("--json", options->is_json, "one JSON document");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace camloc::tools
