// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/localize/localizer_numbers.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

TEST(LocalizerNumbers, EachHasANameAUnitAndAMeaningOfItsOwn) {
  std::set<std::string> names;
  for (const auto& entry : localizer_number_table()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_STRNE(entry.unit, "") << entry.name;
    EXPECT_STRNE(entry.meaning, "") << entry.name;
    LocalizerNumbers numbers;
    EXPECT_TRUE(set_number<LocalizerNumbers>(localizer_number_table(), std::string(entry.name) + "=7", &numbers).is_ok()) << entry.name;
    EXPECT_EQ(number_of(entry, numbers), 7) << entry.name;
  }
}

TEST(LocalizerNumbers, ReachTheLocalizer) {
  const testing::SampleWorld& world = testing::SampleWorld::get();
  LocalizerOptions options;
  ASSERT_TRUE(set_number<LocalizerNumbers>(localizer_number_table(), "min_spread=1.01", &options.numbers).is_ok());
  Localizer strict(world.map(), world.camera(), options);
  EXPECT_EQ(strict.process(world.frame(10).view()).reason, Reason::kPoorSpread);
}

}  // namespace
}  // namespace camloc
