// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// One camera on one walk through one scene: the frame at any time, alone, independent of the frames before it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/frame.h"
#include "core/geometry/camera.h"
#include "tools/camloc-sim/color_sensor.h"
#include "tools/camloc-sim/depth_sensor.h"
#include "tools/camloc-sim/renderer.h"
#include "tools/camloc-sim/walk.h"

namespace camloc::sim {

/// The camera everything is rendered with: 640 x 480, f 525 px, registered depth in units of 0.2 mm.
[[nodiscard]] RgbdCamera simulated_camera();

/// A scene on one day and the walk through it. Read-only while frames are made.
struct World {
  SceneOptions options;
  FloorPlan plan;
  Scene scene;
  Trajectory trajectory;
  std::vector<Passer> passers;
};
[[nodiscard]] World make_world(const SceneOptions& options);

struct FrameMakerOptions {
  bool is_perfect = false;  ///< no sensor noise, blur or dropouts in colour and depth
};

/// Not thread-safe: one per thread. The world must outlive it.
class FrameMaker {
 public:
  FrameMaker(const World& world, const RgbdCamera& camera, const FrameMakerOptions& options);
  /// The frame exposed around `time_s`; `index` seeds its noise. Fills gray and depth only.
  void make(double time_s, std::uint32_t index, const Exposure& exposure, FrameBuffer* frame);
  /// Mean tone a light meter sees at that time.
  [[nodiscard]] float meter(double time_s);
  [[nodiscard]] const Rendering& last_rendering() const { return *rendering_; }

 private:
  [[nodiscard]] float light_drift(double time_s) const;

  const World* world_;
  FrameMakerOptions options_;
  Renderer renderer_, meter_;
  ColorSensor color_sensor_;
  DepthSensor depth_sensor_;
  std::vector<Surface> people_;
  const Rendering* rendering_ = nullptr;
};

}  // namespace camloc::sim
