// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// TOML to Config. The only file of the daemon that sees toml++.
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/io/file_bytes.h"
#include "daemon/config.h"
#include "drivers/source_url.h"

namespace camloc {
namespace {

constexpr std::size_t kMaxFileBytes = 1 << 20;  // a mistaken path should not fill the memory

std::string at(const std::string& name, const toml::source_region& where) { return name + ":" + std::to_string(where.begin.line); }

std::optional<SettingValue> value_of_node(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* number = node.as_integer()) return number->get();
  if (const auto* text = node.as_string()) return text->get();
  return std::nullopt;
}

std::string known_keys(std::string_view section) {
  std::string out;
  for (const Setting& setting : settings()) {
    if (section == setting.section) out += (out.empty() ? "" : ", ") + std::string(setting.key);
  }
  return out;
}

/// Relative paths are meant from `folder`, wherever the daemon is started; empty: from where it is started.
SettingValue from_folder(const Setting& setting, const SettingValue& value, const std::string& folder) {
  const std::string* text = std::get_if<std::string>(&value);
  if (text == nullptr || text->empty() || folder.empty()) return value;
  if (setting.field == SettingField(&Config::source_url)) return source_url_from(folder, *text);
  for (const auto path : {&Config::source_camera, &Config::map_path, &Config::control_socket}) {
    if (setting.field == SettingField(path)) return (std::filesystem::path(folder) / *text).string();  // an absolute one stays
  }
  return value;
}

Status parse_section(const std::string& section, const toml::table& table, const std::string& name, const std::string& folder,
                     Config* config) {
  for (const auto& [key, node] : table) {
    const std::string where = at(name, key.source());
    const Setting* setting = find_setting(section, key.str());
    if (setting == nullptr) {
      return {ErrorCode::kInvalid, where + ": " + section + "." + std::string(key.str()).substr(0, 40) + ": unknown key; [" + section +
                                       "] has " + known_keys(section)};
    }
    const std::optional<SettingValue> value = value_of_node(node);
    if (!value) return {ErrorCode::kInvalid, where + ": " + setting->name() + ": wrong type; see camlocd --print-config"};
    if (const Status status = assign(*setting, from_folder(*setting, *value, folder), config); !status) return status.with_context(where);
  }
  return Status::ok();
}

/// Sorted by name; none when the folder does not exist.
Result<std::vector<std::string>> drop_ins(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".toml") paths.push_back(entry->path());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    return Status(ErrorCode::kIo, "cannot list " + folder + ": " + error.message());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

Status merge_file(const std::string& path, const std::string& folder, Config* config) {
  std::error_code ignored;
  if (path == "/dev/null") return Status::ok();  // how people say that there is no file
  if (std::filesystem::is_directory(path, ignored)) return {ErrorCode::kIo, "cannot read configuration " + path + ": it is a folder"};
  const Result<std::string> text = read_file_text(path, kMaxFileBytes);  // regular files only: a named pipe would wait for a writer
  return text ? parse_config(*text, path, config, folder) : text.status().with_context("cannot read configuration");
}

}  // namespace

Status parse_config(std::string_view text, const std::string& name, Config* config, const std::string& folder) {
  const toml::parse_result parsed = toml::parse(text, name);
  if (!parsed) { return {ErrorCode::kInvalid, at(name, parsed.error().source()) + ": " + std::string(parsed.error().description())}; }
  const toml::table& root = parsed.table();
  Config result = *config;
  for (const auto& [section, node] : root) {
    const std::string title(section.str());
    const toml::table* table = node.as_table();
    if (table == nullptr || known_keys(title).empty()) {
      return {ErrorCode::kInvalid, at(name, section.source()) + ": [" + title.substr(0, 40) +
                                       "]: unknown section; there are source, map, localize, publish, control, log"};
    }
    if (const Status status = parse_section(title, *table, name, folder, &result); !status) return status;
  }
  *config = result;
  return Status::ok();
}

Result<Config> load_config(const std::string& path, const std::vector<std::string>& arguments) {
  Config config;
  const std::string folder = std::filesystem::path(path).parent_path().string();  // of the drop-ins, too: they belong to this file
  if (const Status status = merge_file(path, folder, &config); !status) return status;
  const Result<std::vector<std::string>> extra = drop_ins(path + ".d");
  if (!extra) return extra.status();
  for (const std::string& file : *extra) {
    if (const Status status = merge_file(file, folder, &config); !status) return status;
  }
  for (const std::string& argument : arguments) {
    if (const Status status = assign_argument(argument, &config); !status) return status.with_context("--set");
  }
  return config;
}

}  // namespace camloc
