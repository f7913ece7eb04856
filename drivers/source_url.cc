// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/source_url.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "core/io/text.h"

namespace camloc {

namespace {

/// A '%' that two hexadecimal digits do not follow stays what it is: folders are called "100%" now and then.
std::string percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    if (text[i] == '%' && i + 2 < text.size()) {
      const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16);
      if (error == std::errc() && end == text.data() + i + 3 && value != 0) {
        result += static_cast<char>(value);
        i += 2;
        continue;
      }
    }
    result += text[i];
  }
  return result;
}

bool is_scheme(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-'; });
}

bool has_scheme(std::string_view url) {
  const std::size_t separator = url.find("://");
  return separator != std::string_view::npos && is_scheme(url.substr(0, separator));
}

/// Of a bare path: where its options begin, or its size.
std::size_t path_end(std::string_view text) {
  const std::size_t question = text.find('?');
  std::error_code ignored;
  if (question == std::string_view::npos || std::filesystem::exists(std::filesystem::path(text), ignored)) return text.size();
  return question;
}

Status parse_options(std::string_view query, SourceUrl* url) {
  for (const std::string_view pair : split_fields(query, "&")) {
    const std::size_t equals = pair.find('=');
    const std::string key(pair.substr(0, equals));
    if (equals == std::string_view::npos || key.empty()) {
      return {ErrorCode::kInvalid, url->text + ": option " + in_quotes(pair) + " is not key=value"};
    }
    if (!url->options.emplace(key, percent_decoded(pair.substr(equals + 1))).second) {
      return {ErrorCode::kInvalid, url->text + ": option " + in_quotes(key) + " is given twice"};
    }
  }
  return Status::ok();
}

std::string short_number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  return {text, end};
}

}  // namespace

std::string SourceUrl::text_option(const std::string& key, const std::string& fallback) const {
  const auto option = options.find(key);
  return option == options.end() ? fallback : option->second;
}

Result<double> SourceUrl::number_option(const std::string& key, double fallback, double low, double high) const {
  const auto option = options.find(key);
  if (option == options.end()) return fallback;
  const std::optional<double> value = parse_double(option->second);
  if (!value || !(*value >= low && *value <= high)) {
    return Status(ErrorCode::kInvalid, text + ": option " + key + "=" + option->second + ": expected a number from " + short_number(low) +
                                           " to " + short_number(high));
  }
  return *value;
}

Status SourceUrl::check_options(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : options) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    return {ErrorCode::kInvalid, text + ": unknown option " + in_quotes(key) + "; " + scheme + ":// knows " + list};
  }
  return Status::ok();
}

double OptionReader::number(const std::string& key, double fallback, double low, double high) {
  const Result<double> value = url_.number_option(key, fallback, low, high);
  if (!value && status_) status_ = value.status();
  return value ? *value : fallback;
}

int OptionReader::whole(const std::string& key, int fallback, int low, int high) {
  const double value = number(key, fallback, low, high);
  if (value != std::floor(value)) fail(key, "expected a whole number");
  return static_cast<int>(value);
}

std::optional<double> OptionReader::given_number(const std::string& key, double low, double high) {
  return has(key) ? std::optional(number(key, low, low, high)) : std::nullopt;
}

bool OptionReader::flag(const std::string& key) {
  const std::string value = url_.text_option(key, "0");
  if (value != "0" && value != "1") fail(key, "expected 0 or 1");
  return value == "1";
}

void OptionReader::fail(const std::string& key, const std::string& expected) {
  if (status_) status_ = {ErrorCode::kInvalid, url_.text + ": option " + key + "=" + url_.text_option(key, "") + ": " + expected};
}

std::string replay_url(std::string_view folder) {
  std::string url = "replay://";
  for (const char c : folder) {
    if (c == '%') url += "%25";
    if (c == '?') url += "%3F";
    if (c != '%' && c != '?') url += c;
  }
  return url;
}

std::string as_source_url(const std::string& text) {
  if (has_scheme(text)) return text;
  const std::size_t question = path_end(text);
  return replay_url(text.substr(0, question)) + (question < text.size() ? text.substr(question) : "");
}

std::string source_url_from(const std::string& folder, const std::string& text) {
  if (folder.empty() || text.empty()) return text;
  if (!has_scheme(text)) return text.front() == '/' ? text : (std::filesystem::path(folder) / text).string();
  const std::size_t begin = text.find("://") + 3;
  const std::string scheme = text.substr(0, begin);
  if ((scheme != "replay://" && scheme != "oni://") || begin == text.size() || text[begin] == '/' || text[begin] == '?') return text;
  return scheme + replay_url(folder).substr(std::string_view("replay://").size()) + "/" + text.substr(begin);
}

Result<SourceUrl> parse_source_url(std::string_view url) {
  SourceUrl result;
  result.text = url;
  const std::size_t separator = url.find("://");
  const bool is_url = has_scheme(url);
  std::string_view rest = is_url ? url.substr(separator + 3) : url;
  result.scheme = is_url ? url.substr(0, separator) : "replay";
  std::transform(result.scheme.begin(), result.scheme.end(), result.scheme.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t question = is_url ? std::min(rest.find('?'), rest.size()) : path_end(rest);
  if (question < rest.size()) {
    if (Status status = parse_options(rest.substr(question + 1), &result); !status) return status;
    rest = rest.substr(0, question);
  }
  result.path = is_url ? percent_decoded(rest) : std::string(rest);
  return result;
}

}  // namespace camloc
