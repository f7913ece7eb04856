// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "core/io/text.h"

namespace camloc {
namespace {

constexpr std::int64_t kMaxText = 1000;  // bytes of a path or URL; what a status message can carry

// section, key, field, default, unit, min, max, choices, reloadable, doc
const auto& table() {
  static const std::array kSettings = {
      Setting{"source", "url", &Config::source_url, std::string(), "", 0, kMaxText, "", false,
              "Depth camera or recording: replay://DIR, sample:// and what 'camloc doctor' lists.\n"
              "Empty: no camera; the daemon runs in state NO_CAMERA."},
      Setting{"source", "camera", &Config::source_camera, std::string(), "", 0, kMaxText, "", false,
              "Calibration file of that camera (TOML of camloc, or YAML of kalibr, ROS, OpenCV).\n"
              "Empty: the source knows its own calibration."},
      Setting{"source", "lossless", &Config::source_lossless, false, "", 0, 0, "", false,
              "Recordings: hold a frame back until the one before was taken, instead of dropping. Not for live cameras."},
      Setting{"source", "exit_at_end", &Config::source_exit_at_end, false, "", 0, 0, "", false,
              "Recordings: exit with 0 after the last frame, instead of staying in state NO_CAMERA."},
      Setting{"source", "retry_ms", &Config::source_retry_ms, std::int64_t{500}, "ms", 10, 60000, "", false,
              "Pause before a camera that is missing or went away is tried again."},
      Setting{"source", "stall_ms", &Config::source_stall_ms, std::int64_t{250}, "ms", 50, 60000, "", false,
              "A live camera without a frame for this long is reported as NO_CAMERA and recovered: its stream is restarted, then it\n"
              "is opened again, then reset. Several frame periods; recordings keep their own pace."},
      Setting{"map", "path", &Config::map_path, std::string("/var/lib/camloc/building.cmap"), "", 1, kMaxText, "", true,
              "Map file. Looked for every second while it is missing; 'camloc ctl reload' or SIGHUP opens it anew."},
      Setting{"localize", "features", &Config::localize_features, std::int64_t{1000}, "", 100, 4000, "", true,
              "Most image features per frame: fewer are faster, more find more."},
      Setting{"localize", "tracking", &Config::localize_tracking, true, "", 0, 0, "", true,
              "Predict from the last pose. false: every frame is a kidnapped robot."},
      Setting{"localize", "depth", &Config::localize_depth, true, "", 0, 0, "", true, "Use the depth image, not only the colour image."},
      Setting{"localize", "max_coast_ms", &Config::localize_max_coast_ms, std::int64_t{500}, "ms", 0, 5000, "", true,
              "How long a pose is predicted (COASTING) after the last verified one."},
      Setting{
          "coarse", "cnn", &Config::coarse_cnn, std::string(), "", 0, kMaxText, "", true,
          "Coarse model of this map (camloc train): a neural network that says roughly where the camera is while it is lost. Needs the\n"
          "package camloc-coarse; loaded when a frame is lost, given back after 30 s without one. Empty: off."},
      Setting{"publish", "lcm_url", &Config::publish_lcm_url, std::string("udpm://239.255.76.67:7667?ttl=0"), "", 1, kMaxText, "", false,
              "LCM provider. ttl=0 keeps messages on this machine."},
      Setting{"publish", "pose_channel", &Config::publish_pose_channel, std::string("CAMLOC_POSE"), "", 1, 60, "", false,
              "camloc.pose_t, one message for every camera frame, whatever its state."},
      Setting{"publish", "status_channel", &Config::publish_status_channel, std::string("CAMLOC_STATUS"), "", 1, 60, "", false,
              "camloc.status_t, once a second and on every change of state."},
      Setting{"publish", "bot_core_channel", &Config::publish_bot_core_channel, std::string("POSE"), "", 0, 60, "", false,
              "bot_core.pose_t for viewers that know no other, only while LOCALIZED. Empty: off."},
      Setting{"publish", "frame", &Config::publish_frame, std::string("map"), "", 1, 8, "map|wcs", true,
              "Frame of the published poses. wcs needs a map with a site datum (camloc map georef)."},
      Setting{"control", "socket", &Config::control_socket, std::string("/run/camloc/control.sock"), "", 0, 107, "", false,
              "UNIX socket for 'camloc ctl', mode 0660. Empty: off."},
      Setting{
          "control", "hint_channel", &Config::control_hint_channel, std::string(), "", 0, 60, "", false,
          "LCM channel (CAMLOC_HINT by convention) for camloc.pose_hint_t from trusted programs of this machine: as 'camloc ctl hint'.\n"
          "Wants ttl=0 in publish.lcm_url. Who may send to its group may send hints: route it over lo (camloc-multicast.service)\n"
          "unless all of the network is trusted. Empty: off."},
      Setting{"log", "level", &Config::log_level, std::string("info"), "", 1, 8, "error|warning|info|debug", true,
              "What is logged to stderr."},
  };
  return kSettings;
}

const char* type_name(const SettingField& field) {
  constexpr std::array kNames = {"true or false", "a whole number", "a text"};
  return kNames[field.index()];
}

/// A piece of what the user wrote, for an error message.
std::string excerpt(std::string_view text) { return std::string(1, '\'').append(text.substr(0, 60)).append(1, '\''); }

Status invalid(const Setting& setting, const std::string& why) { return {ErrorCode::kInvalid, setting.name() + ": " + why}; }

std::string range_text(const Setting& setting) {
  const std::string range = std::to_string(setting.min) + " to " + std::to_string(setting.max);
  return setting.unit[0] == '\0' ? range : range + " " + setting.unit;
}

Status check_text(const Setting& setting, const std::string& text) {
  const std::vector<std::string_view> choices = split_fields(setting.choices, "|");
  if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end()) {
    return invalid(setting, excerpt(text) + " is not one of " + setting.choices);
  }
  const auto length = static_cast<std::int64_t>(text.size());
  if (length < setting.min || length > setting.max) {
    return invalid(setting, length == 0 ? "must not be empty" : "longer than " + std::to_string(setting.max) + " bytes");
  }
  const bool has_control = std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  return has_control ? invalid(setting, "holds a control character") : Status::ok();
}

std::string format_value(const SettingValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const std::int64_t* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
  return in_double_quotes(std::get<std::string>(value));
}

/// "# text" lines, then what values are allowed.
std::string format_doc(const Setting& setting) {
  std::string out = "# ";
  for (const char* c = setting.doc; *c != '\0'; ++c) {
    out += *c;
    if (*c == '\n') out += "# ";
  }
  out += '\n';
  std::string note = setting.choices;
  if (std::holds_alternative<std::int64_t Config::*>(setting.field)) note = range_text(setting);
  if (setting.is_reloadable) note += note.empty() ? "applied on reload" : ", applied on reload";
  return note.empty() ? out : out + "# (" + note + ")\n";
}

Result<SettingValue> parse_value(const Setting& setting, const std::string& text) {
  if (std::holds_alternative<std::string Config::*>(setting.field)) return SettingValue(text);
  if (std::holds_alternative<bool Config::*>(setting.field)) {
    if (text == "true" || text == "false") return SettingValue(text == "true");
    return invalid(setting, excerpt(text) + " is not true or false");
  }
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return invalid(setting, excerpt(text) + " is not a whole number");
  return SettingValue(number);
}

}  // namespace

Config::Config() {
  for (const Setting& setting : settings()) {
    std::visit([&](auto field) { this->*field = std::get<std::remove_reference_t<decltype(this->*field)>>(setting.default_value); },
               setting.field);
  }
}

LogLevel Config::parsed_log_level() const {
  if (log_level == "error") return LogLevel::kError;
  if (log_level == "warning") return LogLevel::kWarning;
  return log_level == "debug" ? LogLevel::kDebug : LogLevel::kInfo;
}

std::span<const Setting> settings() { return table(); }

const Setting* find_setting(std::string_view section, std::string_view key) {
  const auto all = settings();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Setting& s) { return s.section == section && s.key == key; });
  return found == all.end() ? nullptr : &*found;
}

Status assign(const Setting& setting, const SettingValue& value, Config* config) {
  if (value.index() != setting.field.index()) return invalid(setting, std::string("wants ") + type_name(setting.field));
  if (const std::string* text = std::get_if<std::string>(&value)) {
    if (const Status status = check_text(setting, *text); !status) return status;
  }
  if (const std::int64_t* number = std::get_if<std::int64_t>(&value);
      number != nullptr && (*number < setting.min || *number > setting.max)) {
    return invalid(setting, std::to_string(*number) + " is out of range, " + range_text(setting));
  }
  std::visit([&](auto field) { config->*field = std::get<std::remove_reference_t<decltype(config->*field)>>(value); }, setting.field);
  return Status::ok();
}

SettingValue value_of(const Setting& setting, const Config& config) {
  return std::visit([&](auto field) { return SettingValue(config.*field); }, setting.field);
}

Status assign_argument(const std::string& argument, Config* config) {
  const std::size_t dot = argument.find('.');
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    return {ErrorCode::kInvalid, excerpt(argument) + " is not section.key=value"};
  }
  const Setting* setting = find_setting(argument.substr(0, dot), argument.substr(dot + 1, equals - dot - 1));
  if (setting == nullptr) return {ErrorCode::kInvalid, argument.substr(0, equals) + ": unknown key; camlocd --print-config lists them"};
  const Result<SettingValue> value = parse_value(*setting, argument.substr(equals + 1));
  return value ? assign(*setting, *value, config) : value.status();
}

std::string format_config(const Config& config) {
  std::string out =
      "# Configuration of camlocd. 'camlocd --print-config' writes this file; 'camlocd --check-config' checks it.\n"
      "# Settings in FILE.d/*.toml come on top, then --set section.key=value. Unknown keys are errors.\n"
      "# Relative paths are meant from the folder of this file.\n";
  std::string_view section;
  for (const Setting& setting : settings()) {
    if (section != setting.section) out += std::string("\n[") + setting.section + "]\n";
    section = setting.section;
    out += format_doc(setting) + setting.key + " = " + format_value(value_of(setting, config)) + "\n";
  }
  return out;
}

}  // namespace camloc
