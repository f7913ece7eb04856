// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Control points known in the map and in a cloud: a text file of "name map_x map_y map_z cloud_x cloud_y cloud_z [sigma]",
// metres, '#' comments.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace camloc::mapping {

struct ControlPair {
  std::string name;
  Eigen::Vector3d p_map, p_cloud;
  double sigma_m = 0.01;
};

/// Errors name file and line: a wrong number of fields, what is no finite number, a sigma that is not positive, a name used
/// twice, fewer than three pairs.
[[nodiscard]] Result<std::vector<ControlPair>> parse_point_pairs(std::string_view text, const std::string& path);
[[nodiscard]] Result<std::vector<ControlPair>> read_point_pairs(const std::string& path);

}  // namespace camloc::mapping
