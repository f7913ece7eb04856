// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of SLAM's numbers: complete, and each name changes its own field and none else.
#include "core/slam/slam_numbers.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace camloc {
namespace {

struct Anything {
  template <class T>
  operator T() const;
};

/// An aggregate takes as many initializers as it has fields.
template <class T, std::size_t... i>
constexpr bool takes(std::index_sequence<i...>) {
  return requires { T{(static_cast<void>(i), Anything())...}; };
}
template <class T, std::size_t kCount = 1>
constexpr std::size_t num_fields() {
  if constexpr (takes<T>(std::make_index_sequence<kCount + 1>()))
    return num_fields<T, kCount + 1>();
  else
    return kCount;
}

TEST(SlamNumbers, EveryNameChangesItsOwnFieldAlone) {
  const SlamNumbers defaults;
  std::set<std::string> names;
  for (const auto& entry : slam_number_table()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " stands twice";
    SlamNumbers numbers;
    const int other = number_of(entry, defaults) == 7 ? 8 : 7;
    ASSERT_TRUE(set_number(slam_number_table(), entry.name + ("=" + std::to_string(other)), &numbers).is_ok()) << entry.name;
    for (const auto& field : slam_number_table()) {
      const bool is_changed = number_of(field, numbers) != number_of(field, defaults);
      EXPECT_EQ(is_changed, &field == &entry) << entry.name << " and " << field.name;
    }
  }
}

TEST(SlamNumbers, NoFieldIsMissingInTheTable) {
  EXPECT_EQ(slam_number_table().size(), num_fields<SlamNumbers>());
  SlamNumbers numbers;
  EXPECT_FALSE(set_number(slam_number_table(), "no_such_number=1", &numbers).is_ok());
}

TEST(SlamNumbers, EveryOneSaysWhatItDecides) {
  for (const auto& entry : slam_number_table()) EXPECT_GT(std::string(entry.meaning).size(), 5U) << entry.name;
}

}  // namespace
}  // namespace camloc
