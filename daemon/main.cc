// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// camlocd: reads its command line and configuration, then runs the service. Exit codes: 0 done, 1 failed, 2 usage or
// configuration.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "core/base/memory_guard.h"
#include "core/io/text.h"
#include "daemon/config.h"
#include "daemon/service.h"
#include "daemon/service_setup.h"
#include "daemon/standard_streams.h"
#include "drivers/sources.h"

namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  camlocd --config /etc/camloc/camlocd.toml --check-config\n"
    "  camlocd --config camlocd.toml --set source.url=replay:///data/walk?speed=1 --set map.path=building.cmap\n"
    "  camlocd --config camlocd.toml --print-config > with-defaults.toml\n"
    "Signals: SIGHUP reloads map and configuration, SIGTERM and SIGINT stop.\n"
    "Exit codes: 0 done, 1 failed, 2 usage or configuration.";

struct Arguments {
  std::string config_path = "/etc/camloc/camlocd.toml";
  std::vector<std::string> settings;
  bool should_check = false;
  bool should_print = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--config", arguments.config_path, "configuration file; FILE.d/*.toml are read after it")->capture_default_str();
  app.add_option("--set", arguments.settings, "section.key=value, stronger than the files; may be repeated")->allow_extra_args(false);
  app.add_flag("--check-config", arguments.should_check, "check the configuration and the files it names, then exit");
  app.add_flag("--print-config", arguments.should_print, "print the configuration that results, with every setting explained, then exit");
  app.set_version_flag("--version", "camlocd " CAMLOC_VERSION);
  app.footer(kExamples);
}

int refuse(const camloc::Status& status, int code) {
  constexpr std::size_t kMaxLine = 4000;  // what a pipe takes as a whole
  const std::string line = camloc::printable("camlocd: " + status.message()).substr(0, kMaxLine) + "\n";
  [[maybe_unused]] const bool was_read = camloc::write_without_waiting(2, line);
  return code;
}

int serve(const camloc::Config& config, const Arguments& arguments) {
  camloc::Result<std::optional<camloc::RgbdCamera>> camera = camloc::read_configured_camera(config);
  if (!camera) return refuse(camera.status(), 2);
  camloc::ServiceInputs inputs;
  inputs.config = config;
  inputs.camera = std::move(camera).value();
  inputs.reload_config = [&arguments] { return camloc::load_config(arguments.config_path, arguments.settings); };
  inputs.open_source = [](const std::string& url) { return camloc::open_frame_source(url); };
  camloc::Service service(std::move(inputs));
  if (const camloc::Status status = service.start(); !status) return refuse(status, 1);
  const int code = service.run();
  // A driver that hangs in the kernel must not hold up the stop: leave without unwinding what it still uses.
  if (!service.stop()) std::_Exit(code);
  return code;
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Localizes a depth camera in a mapped building and publishes its pose over LCM.", "camlocd");
  declare(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? 0 : 2; }
  const camloc::Result<camloc::Config> config = camloc::load_config(arguments.config_path, arguments.settings);
  if (!config) return refuse(config.status(), 2);
  if (arguments.should_print) {
    std::fputs(camloc::format_config(*config).c_str(), stdout);
    return 0;
  }
  const camloc::Status checked = arguments.should_check ? camloc::check_config(*config) : camloc::check_settings(*config);
  if (!checked) return refuse(checked, 2);
  if (arguments.should_check) {
    std::puts("OK");
    return 0;
  }
  const camloc::Status has_room = camloc::check_resource_limits();
  return has_room ? serve(*config, arguments) : refuse(has_room, 1);
}

}  // namespace

int main(int argc, char** argv) {
  camloc::guard_standard_streams();
  camloc::install_memory_guard(
      "camlocd: out of memory; give the service more (MemoryMax, ulimit -v) or take a smaller map (map build --max-bytes)\n");
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {  // no memory or no thread is left
    return refuse({camloc::ErrorCode::kIo, std::string("cannot go on: ") + error.what() + "; is a limit set (ulimit -a, LimitAS=)?"}, 1);
  }
}
