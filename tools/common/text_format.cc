// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/common/text_format.h"

#include <cstdarg>
#include <cstdio>

namespace camloc::tools {
namespace {

void append_arguments(std::string* text, const char* format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  if (size <= 0) return;
  const std::size_t before = text->size();
  text->resize(before + static_cast<std::size_t>(size) + 1);  // vsnprintf ends with a zero
  std::vsnprintf(text->data() + before, static_cast<std::size_t>(size) + 1, format, arguments);
  text->pop_back();
}

}  // namespace

std::string text_of(const char* format, ...) {
  std::string text;
  va_list arguments;
  va_start(arguments, format);
  append_arguments(&text, format, arguments);
  va_end(arguments);
  return text;
}

void append_text(std::string* text, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  append_arguments(text, format, arguments);
  va_end(arguments);
}

}  // namespace camloc::tools
