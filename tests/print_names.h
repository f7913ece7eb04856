// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Every test is compiled with this: GoogleTest prints our enumerators by their names ("kLost") instead of as bytes. The compiler knows
// the names; values from 64 on print as numbers.
#pragma once

#include <array>
#include <ostream>
#include <string_view>
#include <type_traits>
#include <utility>

namespace camloc {
namespace testing {

/// "kLost" for State::kLost, "" for a value that has no enumerator: GCC and clang then write a cast such as "(camloc::State)9".
template <typename Enum, Enum kValue>
constexpr std::string_view enumerator() {
  const std::string_view all = __PRETTY_FUNCTION__;  // "... [with Enum = camloc::State; Enum kValue = camloc::State::kLost; ..."
  const std::size_t begin = all.find("kValue = ") + 9, end = all.find_first_of(";]", begin);
  const std::string_view name = all.substr(begin, end - begin);
  return name.find('(') != std::string_view::npos ? std::string_view() : name.substr(name.rfind(':') + 1);
}

template <typename Enum, std::size_t... kValues>
constexpr auto enumerators(std::index_sequence<kValues...>) {
  return std::array<std::string_view, sizeof...(kValues)>{enumerator<Enum, static_cast<Enum>(kValues)>()...};
}

}  // namespace testing

template <typename Enum>
requires std::is_enum_v<Enum>
void PrintTo(const Enum& value, std::ostream* out) {
  static constexpr auto kNames = testing::enumerators<Enum>(std::make_index_sequence < sizeof(Enum) == 1 ? 128 : 256 > ());
  const auto number = static_cast<std::size_t>(value);
  if (number < kNames.size() && !kNames[number].empty()) {
    *out << kNames[number];
  } else {
    *out << +static_cast<std::underlying_type_t<Enum>>(value);
  }
}

// Looked up in the namespace of the type.
namespace camera_tool {
using camloc::PrintTo;
}
namespace fakes {
using camloc::PrintTo;
}
namespace kinect {
using camloc::PrintTo;
}
namespace mapping {
using camloc::PrintTo;
}
namespace openni2 {
using camloc::PrintTo;
}
namespace sim {
using camloc::PrintTo;
}
namespace tools {
using camloc::PrintTo;
}
}  // namespace camloc
