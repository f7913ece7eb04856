// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>

namespace camloc::tools {

/// For an option whose value is one of these names: the help lists the names, and not what the program calls them.
template <typename Map>
[[nodiscard]] CLI::Validator named_choice(const Map& value_of_name) {
  std::string names;
  for (const auto& [name, value] : value_of_name) names += (names.empty() ? "" : ", ") + name;
  return CLI::CheckedTransformer(value_of_name).description("{" + names + "}");
}

}  // namespace camloc::tools
