// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What readers of lists leave out instead of refusing the whole, counted and named.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace camloc {

/// Lines or images that were left out for one reason.
struct LeftOut {
  std::size_t count = 0;
  int first_line = 0;
  void add(int line) {
    if (count++ == 0) first_line = line;
  }
  /// "rgb.txt: 2 images left out WHY, the first in line 13"; added only where there are any.
  void note(const std::string& file, const char* what, const std::string& why, std::vector<std::string>* notes) const;
};

/// "nan", "-inf", "-1.#IND", "nan(ind)", "NaN": what programs write where they have no number.
[[nodiscard]] bool is_missing_number(std::string_view field);

}  // namespace camloc
