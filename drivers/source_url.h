// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The URL that names a frame source: scheme://path?key=value&key=value.
#pragma once

#include <map>
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

/// %XX is decoded in path and values of a URL with a scheme. A bare path is taken to the letter up to its first '?' and
/// means replay://path.
[[nodiscard]] Result<SourceUrl> parse_source_url(std::string_view url);

}  // namespace camloc
