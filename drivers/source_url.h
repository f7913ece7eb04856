// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The URL that names a frame source: scheme://path?key=value&key=value.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace camloc {

struct SourceUrl {
  std::string text;    ///< as given, for messages
  std::string scheme;  ///< lower case
  std::string path;
  std::map<std::string, std::string> options;

  /// The option's value, or `fallback` where it is not given.
  [[nodiscard]] std::string text_option(const std::string& key, const std::string& fallback) const;
  /// A number in [low, high], or `fallback`.
  [[nodiscard]] Result<double> number_option(const std::string& key, double fallback, double low, double high) const;
  /// An error for the first option that is not among `known`; it lists them.
  [[nodiscard]] Status check_options(const std::vector<std::string>& known) const;
};

/// Takes the options of a URL one by one; the first value that is wrong decides status().
class OptionReader {
 public:
  explicit OptionReader(const SourceUrl& url) : url_(url) {}
  [[nodiscard]] bool has(const std::string& key) const { return url_.options.contains(key); }
  /// See SourceUrl::number_option(); the fallback where the value is wrong, too.
  double number(const std::string& key, double fallback, double low, double high);
  int whole(const std::string& key, int fallback, int low, int high);
  /// 0 or 1; false where it is not given.
  bool flag(const std::string& key);
  /// Nothing where it is not given or not in [low, high].
  std::optional<double> given_number(const std::string& key, double low, double high);
  void fail(const std::string& key, const std::string& expected);
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  const SourceUrl& url_;
  Status status_;
};

/// %XX is decoded in path and values of a URL with a scheme. A bare path is taken to the letter and means replay://path; up to its first
/// '?', where nothing of the whole name exists.
[[nodiscard]] Result<SourceUrl> parse_source_url(std::string_view url);
/// replay:// with `folder` to the letter, whatever it is called.
[[nodiscard]] std::string replay_url(std::string_view folder);
/// Of what people write, the URL: a bare path becomes replay_url() with the options behind it.
[[nodiscard]] std::string as_source_url(const std::string& text);
/// With `folder` in front of a path that is relative, where the scheme's path is a file or folder (bare, replay, oni).
[[nodiscard]] std::string source_url_from(const std::string& folder, const std::string& text);

}  // namespace camloc
