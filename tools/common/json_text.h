// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the reports write as JSON: vectors, rotations, covariances, and the document itself.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/geometry/rigid3.h"

namespace camloc::tools {

using Json = nlohmann::ordered_json;

[[nodiscard]] inline Json json_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }
/// w x y z.
[[nodiscard]] inline Json json_of(const Eigen::Quaterniond& q) { return Json::array({q.w(), q.x(), q.y(), q.z()}); }
/// Row by row.
[[nodiscard]] inline Json json_of(const Matrix6d& m) {
  Json rows = Json::array();
  for (int row = 0; row < 6; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2), m(row, 3), m(row, 4), m(row, 5)});
  return rows;
}

/// The document with a line feed, in ASCII: nothing in it drives a terminal. Bytes that are no UTF-8, as file names may hold, are
/// replaced.
[[nodiscard]] inline std::string json_text(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', true, Json::error_handler_t::replace) + "\n";
}

}  // namespace camloc::tools
