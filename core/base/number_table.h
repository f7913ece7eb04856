// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The numbers that an algorithm weighs by, as one table: name, unit, and where the default was measured. The defaults are those
// of the struct that holds them. From the table follow what "--set NAME=VALUE" may change in an experiment, and its list.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/result.h"

namespace camloc {

/// One field of `Numbers`.
template <typename Numbers>
struct NumberEntry {
  const char* name;
  const char* unit;
  std::variant<double Numbers::*, float Numbers::*, int Numbers::*, std::uint32_t Numbers::*, std::int64_t Numbers::*> field;
  const char* meaning;  ///< what it decides, and what its default was measured on
};

template <typename Numbers>
[[nodiscard]] double number_of(const NumberEntry<Numbers>& entry, const Numbers& numbers) {
  return std::visit([&](auto field) { return static_cast<double>(numbers.*field); }, entry.field);
}

/// "NAME=VALUE" into the field of that name. kInvalid, and nothing changed, for a name that is not in the table (the message lists
/// those that are), for what is no number, and for what the field's type cannot hold.
template <typename Numbers>
[[nodiscard]] Status set_number(std::span<const NumberEntry<Numbers>> table, std::string_view assignment, Numbers* numbers) {
  const std::string_view name = assignment.substr(0, assignment.find('='));
  const std::string_view text = name.size() < assignment.size() ? assignment.substr(name.size() + 1) : std::string_view{};
  std::string known;
  for (const NumberEntry<Numbers>& entry : table) {
    known += std::string(known.empty() ? "" : ", ") + entry.name;
    if (name != entry.name) continue;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    bool is_good = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
    std::visit(
        [&](auto field) {
          using Value = std::remove_reference_t<decltype(numbers->*field)>;
          if constexpr (std::is_integral_v<Value>) {
            is_good = is_good && value == std::floor(value) && value >= static_cast<double>(std::numeric_limits<Value>::min()) &&
                      value <= static_cast<double>(std::numeric_limits<Value>::max() / 2);
          }
          if (is_good) numbers->*field = static_cast<Value>(value);
        },
        entry.field);
    if (is_good) return Status::ok();
    return {ErrorCode::kInvalid, std::string(assignment) + ": not a number that " + entry.name + " can be (" + entry.unit + ")"};
  }
  return {ErrorCode::kInvalid, std::string(name) + ": no such number; there are " + known};
}

}  // namespace camloc
