// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of `camloc eval` that asks whether promised risks and protection levels were kept.
#pragma once

#include <string>
#include <vector>

#include "tools/common/json_text.h"
#include "tools/evaluation/risk_fit.h"
#include "tools/evaluation/risk_report.h"

namespace camloc::tools {

struct RiskArguments {
  std::string records_path, png_path;
  std::vector<std::string> also;  ///< records, reference, records, reference, ...: taken into the same report
  bool is_calibrating = false;
};

/// Of `records_path`, whose poses are judged by `reference` after `T_reference_estimate` was applied, and of all others.
[[nodiscard]] Result<JudgedRun> judge_all(const RiskArguments& arguments, const ReferencePose& reference,
                                          const Rigid3& T_reference_estimate);

[[nodiscard]] Json risk_json(const RiskReport& report);
[[nodiscard]] Json risk_json(const RiskFit& fit);
void print_risk(const RiskReport& report);
/// As the tables of core/localize/integrity.cc hold it.
void print_risk(const RiskFit& fit);

}  // namespace camloc::tools
