// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// LCM needs a route to its multicast group, even between programs of one machine. Asking first gives a better answer than
// LCM's own failure.
#pragma once

#include <string>

#include "core/base/result.h"

namespace camloc::tools {

inline constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

struct MulticastRoute {
  std::string group;          ///< address the URL names, empty for URLs without a network (file://, memq://)
  std::string local_address;  ///< of the interface packets leave by; 127.* stays on this machine
  int ttl = 0;
};

/// kInvalid: not an LCM URL; kUnavailable: no route, with the commands that add one.
[[nodiscard]] Result<MulticastRoute> find_multicast_route(const std::string& lcm_url);

}  // namespace camloc::tools
