// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Draws a scene into a pinhole camera: which surface each pixel sees, by rasterizing rectangles into a buffer of inverse
// distances (affine over a plane's image, so depth is exact), then one evaluation of light and texture per pixel, four on
// silhouettes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "tools/camloc-sim/scene.h"

namespace camloc::sim {

/// What an ideal camera sees.
struct Rendering {
  Image<float> radiance;        ///< linear, 0.2 is a usual indoor value
  Image<float> depth_m;         ///< z of the nearest surface, 0 where there is none
  Image<float> cosine;          ///< of the angle between ray and normal, 0 where there is no surface
  Image<std::int32_t> surface;  ///< index into scene surfaces, then the extra ones; -1 none
};

/// Not thread-safe; keeps its buffers. The scene must outlive it.
class Renderer {
 public:
  Renderer(const Scene& scene, const Intrinsics& intrinsics);
  /// `extra`: surfaces of this moment only (people), their light baked.
  const Rendering& render(const Rigid3& T_world_camera, std::span<const Surface> extra);
  [[nodiscard]] const Surface& seen_surface(int index) const;

 private:
  /// A surface's plane and axes in the camera frame of the current view.
  struct View {
    const Surface* surface = nullptr;
    float normal[3] = {};  // inverse_depth = dot(normal, ray)
    float u_ray[3] = {};   // u = depth * dot(u_ray, ray) + u_offset
    float v_ray[3] = {};
    float u_offset = 0, v_offset = 0;
    float inverse_distance = 0;  // 1 / distance of the camera from the plane, > 0
  };
  struct Hit {
    float u, v, depth, cosine;
  };

  bool make_view(const Surface& surface, View* view) const;
  void draw(const Surface& surface, std::int32_t index);
  void fill_polygon(const std::vector<Eigen::Vector2d>& polygon, const View& view, std::int32_t index);
  [[nodiscard]] Hit intersect(const View& view, float ray_x, float ray_y) const;
  [[nodiscard]] float shade(const View& view, const Hit& hit) const;
  [[nodiscard]] float shade_silhouette(int x, int y) const;
  void shade_all();

  const Scene* scene_;
  Intrinsics intrinsics_;
  std::span<const Surface> extra_;
  Eigen::Matrix3d R_camera_world_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d camera_position_ = Eigen::Vector3d::Zero();
  std::vector<View> views_;  // by surface index; only those drawn are valid
  Image<float> inverse_depth_;
  Rendering rendering_;
  std::vector<Eigen::Vector2d> polygon_;
};

}  // namespace camloc::sim
