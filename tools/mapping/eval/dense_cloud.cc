// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "drivers/sources.h"
#include "tools/common/frame_reading.h"
#include "tools/mapping/eval/evaluation.h"

namespace camloc::mapping {
namespace {

constexpr int kPixelStep = 2;            // along rows and columns
constexpr double kMaxDepthM = 3.5;       // farther, the noise of depth cameras exceeds centimetres
constexpr std::uint32_t kMinPoints = 3;  // a voxel with fewer is a flying pixel

/// A neighbour that is farther away than noise and slope explain: the pixel may mix both sides.
bool is_at_edge(const RgbdCamera& camera, ImageView<std::uint16_t> depth, int x, int y, double z_m) {
  const double limit_m = 0.05 * z_m + 3 * camera.depth_noise.sigma_m(z_m);
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) return true;
    const auto neighbor_m = static_cast<double>(camera.depth_m(depth.at(u, v)));
    if (neighbor_m <= 0 || std::abs(neighbor_m - z_m) > limit_m) return true;
  }
  return false;
}

}  // namespace

void add_depth_image(const RgbdCamera& camera, ImageView<std::uint16_t> depth, const Rigid3& T_world_camera, CloudAccumulator* cloud) {
  const Rigid3 T_world_depth = camera.is_depth_registered ? T_world_camera : T_world_camera * camera.T_color_depth;
  const Intrinsics& lens = camera.is_depth_registered ? camera.color : camera.depth;
  for (int y = kPixelStep / 2; y < depth.height; y += kPixelStep) {
    for (int x = kPixelStep / 2; x < depth.width; x += kPixelStep) {
      const auto z_m = static_cast<double>(camera.depth_m(depth.at(x, y)));
      if (z_m <= 0 || z_m > kMaxDepthM || is_at_edge(camera, depth, x, y, z_m)) continue;
      const Eigen::Vector2d ray = lens.undistort({x, y});
      cloud->add(T_world_depth * Eigen::Vector3d(z_m * ray.x(), z_m * ray.y(), z_m));
    }
  }
}

Result<PointCloud> fuse_dense_cloud(const PosedFrames& frames, const RgbdCamera& camera, double voxel_m, WorkObserver& observer) {
  auto source = open_frame_source(frames.url);
  if (!source.is_ok()) return source.status();
  CloudAccumulator accumulator({voxel_m, 1, kMinPoints});
  const Intrinsics& lens = camera.is_depth_registered ? camera.color : camera.depth;
  std::uint64_t done = 0;
  const auto add = [&](FrameBuffer& buffer) -> Status {
    if (!observer.on_progress("fusing depth images: " + std::to_string(++done) + " of " +
                              std::to_string(frames.T_map_camera_of_frame.size())))
      return {ErrorCode::kIo, "interrupted while fusing depth images"};
    const auto pose = frames.T_map_camera_of_frame.find(buffer.sequence);
    const bool is_usable = buffer.depth.width == lens.width && buffer.depth.height == lens.height;
    if (pose != frames.T_map_camera_of_frame.end() && is_usable) add_depth_image(camera, buffer.depth.view(), pose->second, &accumulator);
    return Status::ok();
  };
  if (const auto counts = tools::read_frames(*source.value(), add); !counts) return counts.status();
  PointCloud cloud = accumulator.finish();
  if (cloud.points_m.empty()) return {ErrorCode::kInvalid, frames.folder + ": its frames give no surface; check depth images and --camera"};
  return cloud;
}

}  // namespace camloc::mapping
