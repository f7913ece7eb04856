// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What camlocd can be told. One table gives every setting its key, unit, range, default and text; parsing, checking,
// --print-config, the shipped file and its test all come from it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"
#include "daemon/log.h"

namespace camloc {

/// Field names are section_key. A default-constructed Config holds the defaults of the table.
struct Config {
  Config();

  std::string source_url, source_camera;
  bool source_lossless, source_exit_at_end;
  std::int64_t source_retry_ms, source_stall_ms;
  std::string map_path;
  std::int64_t localize_features;
  bool localize_tracking, localize_depth;
  std::int64_t localize_max_coast_ms;
  std::string coarse_cnn;
  std::string publish_lcm_url, publish_pose_channel, publish_status_channel, publish_bot_core_channel, publish_frame;
  std::string control_socket, control_hint_channel;
  std::string log_level;

  [[nodiscard]] LogLevel parsed_log_level() const;
};

using SettingValue = std::variant<bool, std::int64_t, std::string>;
using SettingField = std::variant<bool Config::*, std::int64_t Config::*, std::string Config::*>;

struct Setting {
  const char* section;
  const char* key;
  SettingField field;
  SettingValue default_value;
  const char* unit;       ///< "" where there is none
  std::int64_t min, max;  ///< of a number; of a text the number of bytes
  const char* choices;    ///< "a|b|c" for a text with few values, else ""
  bool is_reloadable;     ///< a reload applies it; otherwise it needs a restart
  const char* doc;

  [[nodiscard]] std::string name() const { return std::string(section) + "." + key; }
};

/// In the order of the file, the settings of a section together.
[[nodiscard]] std::span<const Setting> settings();
/// nullptr when there is no such setting.
[[nodiscard]] const Setting* find_setting(std::string_view section, std::string_view key);

/// Checks type and range. Errors: kInvalid, without file and line, which the caller knows.
[[nodiscard]] Status assign(const Setting& setting, const SettingValue& value, Config* config);
[[nodiscard]] SettingValue value_of(const Setting& setting, const Config& config);
/// From the command line: "section.key=value"; texts need no quotes.
[[nodiscard]] Status assign_argument(const std::string& argument, Config* config);

/// A configuration file with every setting, its text, unit and range; parses back to the same Config.
[[nodiscard]] std::string format_config(const Config& config);

/// From TOML. Errors: kInvalid with "name:line: section.key: why". Relative paths get `folder` in front.
[[nodiscard]] Status parse_config(std::string_view toml, const std::string& name, Config* config, const std::string& folder = "");
/// Relative paths in the files are meant from the folder of `path`, those of `arguments` from where the daemon is started. The file, then
/// its drop-ins FILE.d/*.toml in the order of their names, then the `arguments` (section.key=value).
[[nodiscard]] Result<Config> load_config(const std::string& path, const std::vector<std::string>& arguments);

}  // namespace camloc
