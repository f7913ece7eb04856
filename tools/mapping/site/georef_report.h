// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What `camloc map georef` says: the residual table, the datum, and what is wrong.
#pragma once

#include <string>
#include <vector>

#include "tools/mapping/site/georef_fit.h"

namespace camloc::mapping {

struct GeorefSummary {
  std::string map_path, points_path, observed_path, out_path;
  GeorefFit fit;
  std::vector<std::string> left_out;                          ///< observations without a point
  std::vector<std::string> only_in_points, only_in_observed;  ///< names without partner
  bool is_written = false;
  bool has_replaced_datum = false;
};

[[nodiscard]] std::string format_table(const GeorefSummary& summary);
[[nodiscard]] std::string format_json(const GeorefSummary& summary);

}  // namespace camloc::mapping
