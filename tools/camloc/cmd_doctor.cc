// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc doctor`: what of an installation works, and what to do about the rest. Changes nothing.
#include <toml++/toml.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/features/hamming.h"
#include "core/map/map_view.h"
#include "drivers/camera_file.h"
#include "drivers/frame_source.h"
#include "tools/camloc/commands.h"
#include "tools/camloc/control_client.h"
#include "tools/camloc/multicast_route.h"
#include "tools/camloc/program.h"

namespace camloc::tools {
namespace {

constexpr std::uint64_t kMinMemoryKb = 65536;  // camlocd needs half of that with a map of one building

struct DoctorOptions {
  std::string config_path = "/etc/camloc/camlocd.toml";
  std::optional<std::string> map_path, source_url, camera_path, lcm_url, socket_path;
  bool is_json = false;
};

enum class Level { kOk, kWarning, kFailure };

struct Check {
  std::string name;
  Level level = Level::kOk;
  std::string detail;
  std::string advice;  // what to do, empty when nothing
};

const char* to_string(Level level) { return level == Level::kOk ? "ok" : level == Level::kWarning ? "warn" : "FAIL"; }

/// What camlocd would run with: its configuration, then the command line of doctor.
struct Settings {
  std::string map_path, source_url, camera_path;
  std::string lcm_url = kDefaultLcmUrl;
  std::string socket_path = kDefaultControlSocket;
};

void read_setting(const toml::table& config, const char* key, std::string* setting) {
  if (const auto value = config.at_path(key).value<std::string>()) *setting = *value;
}

void read_settings(const std::string& config_text, Settings* settings) {
  const toml::parse_result config = toml::parse(config_text);
  if (!config) return;  // the configuration check has said so already: defaults remain
  read_setting(config.table(), "map.path", &settings->map_path);
  read_setting(config.table(), "source.url", &settings->source_url);
  read_setting(config.table(), "source.camera", &settings->camera_path);
  read_setting(config.table(), "publish.lcm_url", &settings->lcm_url);
  read_setting(config.table(), "control.socket", &settings->socket_path);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

Check check_config(const std::string& path, Settings* settings) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return {"config", Level::kFailure, path + " does not exist", "install the package camloc, or name your file with --config"};
  }
  const auto camlocd = find_program("camlocd");
  if (!camlocd) return {"config", Level::kWarning, "not checked: " + camlocd.status().message(), "install the package camloc"};
  const auto checked = run_program(*camlocd, {"--config", path, "--check-config"}, std::chrono::seconds(10));
  if (!checked) return {"config", Level::kFailure, checked.status().message(), "run 'camlocd --check-config' yourself"};
  if (checked->exit_code != 0)
    return {"config", Level::kFailure, first_line(checked->err + checked->out), "correct that line of the file"};
  const auto printed = run_program(*camlocd, {"--config", path, "--print-config"}, std::chrono::seconds(10));
  if (printed && printed->exit_code == 0) read_settings(printed->out, settings);
  return {"config", Level::kOk, path, ""};
}

Check check_map(const std::string& path) {
  if (path.empty()) {
    return {"map", Level::kFailure, "none configured",
            "build one with 'camloc map build', then set map.path in the configuration"};
  }
  const auto map = MapView::open(path);
  if (!map) return {"map", Level::kFailure, map.status().message(), "build it with 'camloc map build' or copy it again"};
  const MapInfo& info = map->info();
  return {"map", Level::kOk,
          path + ": " + std::to_string(info.num_landmarks) + " landmarks, " + std::to_string(info.num_keyframes) +
              " keyframes, " + std::to_string(info.file_bytes / 1000) + " kB",
          ""};
}

/// `daemon` is the answer of a running camlocd, which may have seen that the calibration does not fit.
Check check_camera_file(const std::string& path, const std::optional<nlohmann::ordered_json>& daemon) {
  const std::string name = path.empty() ? "that of the source" : path;
  if (!path.empty()) {
    const auto camera = read_camera_file(path);
    if (!camera) return {"calibration", Level::kFailure, camera.status().message(), "correct that file or set another one"};
  }
  if (daemon && daemon->value("is_calibration_suspect", false)) {
    const double scale = daemon->value("focal_scale", 1.0);
    return {"calibration", Level::kWarning,
            name + ": the images fit the map with " + std::to_string(scale) + " times its focal length",
            "set the calibration of this camera, or calibrate it"};
  }
  return {"calibration", Level::kOk, name, ""};
}

std::string known_schemes() {
  std::string text;
  for (const auto& scheme : frame_source_schemes()) text += (text.empty() ? "" : ", ") + scheme.scheme + "://";
  return text;
}

/// `daemon` is the answer of a running camlocd, which then owns the camera.
Check check_source(const std::string& url, const std::optional<nlohmann::ordered_json>& daemon) {
  if (url.empty()) return {"camera", Level::kFailure, "none configured", "set source.url; this build knows " + known_schemes()};
  if (daemon) {
    const bool has_camera = daemon->value("state", std::string()) != "NO_CAMERA";
    if (has_camera) return {"camera", Level::kOk, url + ": in use by camlocd", ""};
    return {"camera", Level::kFailure, url + ": camlocd gets no frames",
            "check cable and power; 'journalctl -u camlocd' has the reason"};
  }
  auto source = open_frame_source(url);
  if (!source) return {"camera", Level::kFailure, source.status().message(), "this build knows " + known_schemes()};
  FrameBuffer frame;
  const Status status = (*source)->next(&frame, std::chrono::seconds(3));
  if (!status)
    return {"camera", Level::kFailure, url + ": " + status.message(), "check cable, power and permission of the device"};
  return {"camera", Level::kOk,
          url + ": " + std::to_string(frame.gray.width) + "x" + std::to_string(frame.gray.height) + " image, " +
              std::to_string(frame.depth.width) + "x" + std::to_string(frame.depth.height) + " depth",
          ""};
}

Check check_daemon(const std::string& socket_path, std::optional<nlohmann::ordered_json>* daemon) {
  auto answer = control_request(socket_path, "status", std::chrono::seconds(3));
  if (answer) {
    *daemon = *answer;
    return {"daemon", Level::kOk, socket_path + ": " + answer->value("state", std::string("answers")), ""};
  }
  const bool is_absent = answer.status().code() == ErrorCode::kUnavailable;
  return {"daemon", is_absent ? Level::kWarning : Level::kFailure, answer.status().message(),
          is_absent ? "" : "'journalctl -u camlocd' has the reason"};
}

Check check_lcm(const std::string& url) {
  const auto route = find_multicast_route(url);
  if (!route) return {"lcm", Level::kFailure, route.status().message(), ""};
  if (route->group.empty()) return {"lcm", Level::kOk, url + ": no network", ""};
  const bool is_local = route->local_address.rfind("127.", 0) == 0;
  const std::string detail = url + ": leaves by " + route->local_address;
  if (!is_local && route->ttl == 0) return {"lcm", Level::kOk, detail + ", ttl=0 keeps it on this machine", ""};
  if (!is_local)
    return {"lcm", Level::kWarning, detail + " with ttl=" + std::to_string(route->ttl),
            "poses leave this machine; set ttl=0 unless you want that"};
  return {"lcm", Level::kOk, detail, ""};
}

Check check_cpu() {
  const HammingKernel kernel = best_hamming_kernel();
  const std::string detail = std::string("descriptor matching with ") + camloc::to_string(kernel);
  if (kernel == HammingKernel::kScalar)
    return {"cpu", Level::kWarning, detail, "expect a lower frame rate; in a virtual machine pass the host's CPU through"};
  return {"cpu", Level::kOk, detail, ""};
}

Check check_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  for (std::uint64_t kilobytes = 0; file >> key >> kilobytes; file.ignore(100, '\n')) {
    if (key != "MemAvailable:") continue;
    const std::string detail = std::to_string(kilobytes / 1024) + " MiB available";
    if (kilobytes < kMinMemoryKb) return {"memory", Level::kWarning, detail, "camlocd needs about 32 MiB and the map"};
    return {"memory", Level::kOk, detail, ""};
  }
  return {"memory", Level::kWarning, "/proc/meminfo does not say", ""};
}

std::vector<Check> examine(const DoctorOptions& options) {
  Settings settings;
  std::vector<Check> checks{check_config(options.config_path, &settings)};
  settings.map_path = options.map_path.value_or(settings.map_path);
  settings.source_url = options.source_url.value_or(settings.source_url);
  settings.camera_path = options.camera_path.value_or(settings.camera_path);
  settings.lcm_url = options.lcm_url.value_or(settings.lcm_url);
  settings.socket_path = options.socket_path.value_or(settings.socket_path);

  std::optional<nlohmann::ordered_json> daemon;
  checks.push_back(check_daemon(settings.socket_path, &daemon));
  checks.push_back(check_map(settings.map_path));
  checks.push_back(check_source(settings.source_url, daemon));
  checks.push_back(check_camera_file(settings.camera_path, daemon));
  checks.push_back(check_lcm(settings.lcm_url));
  checks.push_back(check_cpu());
  checks.push_back(check_memory());
  return checks;
}

void print_text(const std::vector<Check>& checks) {
  for (const auto& check : checks) {
    std::printf("%-4s  %-12s %s\n", to_string(check.level), check.name.c_str(), check.detail.c_str());
    if (!check.advice.empty()) std::printf("                   -> %s\n", check.advice.c_str());
  }
}

void print_json(const std::vector<Check>& checks, bool is_ok) {
  nlohmann::json document{{"ok", is_ok}, {"checks", nlohmann::json::array()}};
  for (const auto& check : checks) {
    const char* level = check.level == Level::kFailure ? "fail" : to_string(check.level);
    document["checks"].push_back({{"name", check.name}, {"level", level}, {"detail", check.detail}, {"advice", check.advice}});
  }
  std::printf("%s\n", document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int run(const DoctorOptions& options) {
  const std::vector<Check> checks = examine(options);
  bool is_ok = true;
  for (const auto& check : checks) is_ok = is_ok && check.level != Level::kFailure;
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
  CLI::App* command = app.add_subcommand("doctor", "Check configuration, map, camera, network, machine; say what to do");
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
