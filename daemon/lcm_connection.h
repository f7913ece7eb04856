// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// LCM opened with one line for an error, for what sends and for what listens.
#pragma once

#include <lcm/lcm.h>

#include <memory>
#include <string>

#include "core/base/result.h"

namespace camloc {

struct LcmDelete {
  void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
};
using Lcm = std::unique_ptr<lcm_t, LcmDelete>;

/// kUnavailable, try again later: no multicast route yet, or LCM refused.
[[nodiscard]] Result<Lcm> connect_lcm(const std::string& url);

}  // namespace camloc
