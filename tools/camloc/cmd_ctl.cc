// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// `camloc ctl`: asks a running camlocd for its status, to reload its map, to forget its pose, and tells it where the camera is about.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "tools/camloc/commands.h"
#include "tools/common/control_client.h"
#include "tools/common/text_format.h"

namespace camloc::tools {
namespace {

struct CtlOptions {
  std::string command;  // a whole line, of which the first word names it
  double x_m = 0, y_m = 0, z_m = 0, yaw_deg = 0, radius_m = 0;
  std::string socket_path = kDefaultControlSocket;
  bool is_json = false;
  int timeout_ms = 10000;
};

std::string plain_text(const nlohmann::ordered_json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// One "key  value" line each; what is nested is indented by its parent's name.
void print_table(const nlohmann::ordered_json& object, const std::string& prefix) {
  for (const auto& [key, value] : object.items()) {
    if (prefix.empty() && key == "ok") continue;
    if (value.is_object()) {
      print_table(value, prefix + key + ".");
    } else {
      std::printf("%-26s %s\n", printable(prefix + key).c_str(), printable(plain_text(value)).c_str());
    }
  }
}

int run(const CtlOptions& options) {
  const std::string name = options.command.substr(0, options.command.find(' '));
  const auto answer = control_request(options.socket_path, options.command, std::chrono::milliseconds(options.timeout_ms));
  if (!answer) return report(answer.status());
  const bool is_ok = answer->value("ok", false);
  if (options.is_json) {
    std::printf("%s\n", answer->dump(-1, ' ', true).c_str());
  } else if (!is_ok) {
    const std::string why = answer->contains("error") ? plain_text((*answer)["error"]) : "no reason given";
    return report({ErrorCode::kUnavailable, name + " refused: " + why});
  } else if (answer->size() <= 1) {
    std::printf("%s: done\n", name.c_str());
  } else {
    print_table(*answer, "");
  }
  return is_ok ? 0 : 1;
}

}  // namespace

void add_ctl_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CtlOptions>();
  CLI::App* ctl = app.add_subcommand("ctl", "Ask a running camlocd: status, reload, reset, hint");
  ctl->require_subcommand(1);
  ctl->fallthrough();
  ctl->add_option("--socket", options->socket_path, "control socket of camlocd")->capture_default_str();
  ctl->add_option("--timeout-ms", options->timeout_ms, "wait this long for the answer")
      ->check(CLI::Range(1, 600000))
      ->capture_default_str();
  ctl->add_flag("--json", options->is_json, "print the answer as it came");
  const auto add = [&](const char* name, const char* help) {
    ctl->add_subcommand(name, help)->callback([options, name, &exit_code] {
      options->command = name;
      exit_code = run(*options);
    });
  };
  add("status", "state, map, source, counters");
  add("reload", "open the map again; a bad one is refused and the old one kept");
  add("reset", "forget the last pose and search the whole map");
  CLI::App* hint = ctl->add_subcommand("hint", "tell where the camera is about, in the map's frame: a place to look first, never evidence");
  hint->add_option("X", options->x_m, "metres")->required();
  hint->add_option("Y", options->y_m, "metres")->required();
  hint->add_option("Z", options->z_m, "metres")->required();
  hint->add_option("YAW", options->yaw_deg, "heading of the optical axis about the map's z axis, from x towards y, degrees")->required();
  hint->add_option("RADIUS", options->radius_m, "the camera is this near to X Y Z, metres; above 0, at most 20")->required();
  hint->callback([options, &exit_code] {
    options->command =
        text_of("hint %.9g %.9g %.9g %.9g %.9g", options->x_m, options->y_m, options->z_m, options->yaw_deg, options->radius_m);
    exit_code = run(*options);
  });
}

}  // namespace camloc::tools
