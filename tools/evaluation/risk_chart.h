// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A risk report as a picture of four charts: promised against observed risk, coverage, misleading poses against availability, NEES by
// inliers.
#pragma once

#include <string>

#include "tools/evaluation/risk_report.h"

namespace camloc::tools {

/// Writes a PNG.
[[nodiscard]] Status write_risk_chart(const RiskReport& report, const std::string& path);

}  // namespace camloc::tools
