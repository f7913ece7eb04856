// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/lidar.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/io/file_bytes.h"
#include "tools/camloc-sim/normal_table.h"

namespace camloc::sim {
namespace {

void append_float(std::string* out, double value) {
  static_assert(std::endian::native == std::endian::little);
  const auto single = static_cast<float>(value);
  char bytes[4];
  std::memcpy(bytes, &single, 4);
  out->append(bytes, 4);
}

std::uint64_t append_surface(const Surface& s, const LidarOptions& options, const NormalTable& normal, Xorshift* random, std::string* out) {
  const int columns = static_cast<int>(s.width / options.step_m), rows = static_cast<int>(s.height / options.step_m);
  const Eigen::Vector3d up = s.normal();
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = s.width * (i + double{unit((*random)())}) / columns;
      const double v = s.height * (j + double{unit((*random)())}) / rows;
      const Eigen::Vector3d p = s.at(u, v) + options.noise_m * normal((*random)()) * up;
      for (int k = 0; k < 3; ++k) append_float(out, p[k]);
      const float tone = texture_tone(s.skin, static_cast<float>(u) + s.texture_u, static_cast<float>(v) + s.texture_v, s.texture_width,
                                      s.texture_height, 0.01F);
      out->push_back(static_cast<char>(static_cast<std::uint8_t>(std::clamp(255.0F * tone, 0.0F, 255.0F))));
    }
  }
  return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
}

}  // namespace

Result<std::uint64_t> write_lidar_ply(const std::string& path, const Scene& scene, const LidarOptions& options) {
  const NormalTable normal;
  Xorshift random(hash32(options.seed, 6000));
  std::string points;
  std::uint64_t count = 0;
  for (const Surface& surface : scene.surfaces) {
    if (surface.is_static) count += append_surface(surface, options, normal, &random, &points);
  }
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment camloc-sim, metres, world frame\nelement vertex " +
                             std::to_string(count) +
                             "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar intensity\nend_header\n";
  if (Status status = replace_file(path, header + points); !status) return status;
  return count;
}

}  // namespace camloc::sim
