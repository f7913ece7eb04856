// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary bytes as a point cloud file: finite points, or an error in one line.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "tools/mapping/cloud/point_cloud.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  const auto cloud = camloc::mapping::read_cloud(stream, "fuzz", {});
  if (!cloud) {
    require(!cloud.status().message().empty() && cloud.status().message().find('\n') == std::string::npos);
    return 0;
  }
  require(!cloud->points_m.empty() && cloud->points_m.size() <= cloud->num_read - cloud->num_invalid && cloud->num_read <= size);
  require(cloud->origin_m.allFinite());
  for (const Eigen::Vector3f& p : cloud->points_m) require(p.allFinite());
  return 0;
}
