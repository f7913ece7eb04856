// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/left_out.h"

#include <algorithm>

namespace camloc {

void LeftOut::note(const std::string& file, const char* what, const std::string& why, std::vector<std::string>* notes) const {
  if (count == 0 || notes == nullptr) return;
  notes->push_back(file + ": " + std::to_string(count) + " " + what + (count == 1 ? "" : "s") + " left out " + why + ", " +
                   (count == 1 ? "line " : "the first in line ") + std::to_string(first_line));
}

bool is_missing_number(std::string_view field) {
  std::string word(field);
  std::transform(word.begin(), word.end(), word.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (word.starts_with('-') || word.starts_with('+')) word.erase(0, 1);
  return word.starts_with("nan") || word.starts_with("inf") || word.starts_with("1.#") || word == "none" || word == "null";
}

}  // namespace camloc
