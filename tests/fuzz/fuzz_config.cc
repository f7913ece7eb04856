// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Any text as configuration file and as --set argument: accepted or refused with one line, and what was accepted survives
// being printed and read again.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  camloc::Config config;
  const camloc::Status status = camloc::parse_config(text, "fuzz.toml", &config);
  if (!status && status.message().empty()) std::abort();
  const camloc::Status argument = camloc::assign_argument(text, &config);
  if (!argument && argument.message().empty()) std::abort();

  camloc::Config again;
  if (!camloc::parse_config(camloc::format_config(config), "printed.toml", &again)) std::abort();
  for (const camloc::Setting& setting : camloc::settings()) {
    if (camloc::value_of(setting, config) != camloc::value_of(setting, again)) std::abort();
  }
  return 0;
}
