// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A line of a table of points, as surveyors' programs and spreadsheets write it. What all lists of points are read with.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace camloc::mapping {

/// The fields of a line, without quotes and surrounding blanks. They look into the line, or into `buffer`.
using Row = std::vector<std::string_view>;

/// Separators are ';', else tabs, else ',' where that leaves at least `min_fields`, else blanks. With the first three a name may hold
/// blanks and empty fields are kept out; with ';' and tabs a comma between digits is the decimal sign (of a line without a decimal point).
/// A quoted field may hold any separator. Blanks and then '#' begin a comment.
[[nodiscard]] Row split_row(std::string_view line, std::size_t min_fields, std::string* buffer);

/// True where blanks separate and the second field of `row` looks like the end of a name ("Door 3 0.500 0.400 0.600"): a whole number
/// before nothing but decimal fractions. What to do about it: kSplitNameAdvice.
[[nodiscard]] bool has_split_name(std::string_view line, const Row& row);
inline constexpr const char* kSplitNameAdvice =
    "does the name hold a blank? Then put it in quotes or separate by tabs or ';'; else write the first number with a decimal point";

}  // namespace camloc::mapping
