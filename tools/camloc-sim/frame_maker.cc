// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/frame_maker.h"

#include <cmath>

#include "tools/camloc-sim/noise.h"

namespace camloc::sim {
namespace {

/// A sixteenth of the pixels in each direction is plenty for a mean.
Intrinsics meter_intrinsics(const Intrinsics& full) {
  constexpr int kReduction = 10;
  Intrinsics small = full;
  small.width = full.width / kReduction;
  small.height = full.height / kReduction;
  small.fx = full.fx / kReduction;
  small.fy = full.fy / kReduction;
  small.cx = (full.cx + 0.5) / kReduction - 0.5;
  small.cy = (full.cy + 0.5) / kReduction - 0.5;
  return small;
}

}  // namespace

RgbdCamera simulated_camera() {
  RgbdCamera camera;
  const DepthSensorOptions sensor;
  camera.name = "camloc-sim";
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 525.0;
  camera.color.cx = 319.5;
  camera.color.cy = 239.5;
  camera.depth = camera.color;
  camera.depth_unit_m = sensor.unit_m;
  camera.min_depth_m = 0.4;
  camera.max_depth_m = 5.5;
  camera.depth_noise = expected_noise(sensor);
  return camera;
}

World make_world(const SceneOptions& options) {
  FloorPlan plan = floor_plan(options.kind, options.seed);
  Scene scene = build_scene(plan, options);
  Trajectory trajectory(walk_path(plan, options.kind, options.day), walk_style(options.kind, options.day, options.seed));
  std::vector<Passer> passers = plan_passers(plan, trajectory, options);
  return {options, std::move(plan), std::move(scene), std::move(trajectory), std::move(passers)};
}

FrameMaker::FrameMaker(const World& world, const RgbdCamera& camera, const FrameMakerOptions& options)
    : world_(&world),
      options_(options),
      renderer_(world.scene, camera.color),
      meter_(world.scene, meter_intrinsics(camera.color)),
      color_sensor_(camera.color),
      depth_sensor_(camera.color, {.is_perfect = options.is_perfect, .unit_m = camera.depth_unit_m}) {}

float FrameMaker::light_drift(double time_s) const {
  const auto seed = hash32(world_->options.seed, world_->options.day, 4000);
  const float t = static_cast<float>(time_s);
  return 1.0F + 0.15F * value_noise(t / 9.0F, 0.5F, seed) + 0.04F * value_noise(t / 1.5F, 0.5F, seed + 1);
}

float FrameMaker::meter(double time_s) {
  people_ = people_at(world_->plan, world_->scene, world_->passers, time_s);
  const Rendering& small = meter_.render(world_->trajectory.pose(time_s), people_);
  double sum = 0;
  for (const float radiance : small.radiance.pixels) sum += std::min(1.0F, std::sqrt(radiance));
  return static_cast<float>(sum / static_cast<double>(small.radiance.pixels.size())) * std::sqrt(light_drift(time_s));
}

void FrameMaker::make(double time_s, std::uint32_t index, const Exposure& exposure, FrameBuffer* frame) {
  people_ = people_at(world_->plan, world_->scene, world_->passers, time_s);
  rendering_ = &renderer_.render(world_->trajectory.pose(time_s), people_);
  const std::uint32_t seed = hash32(world_->options.seed, world_->options.day * 1000000U + index, 5000);
  Exposure drifted = exposure;
  drifted.gain *= light_drift(time_s);
  color_sensor_.expose(*rendering_, world_->trajectory.twist(time_s), drifted, seed, options_.is_perfect, &frame->gray);
  depth_sensor_.measure(*rendering_, renderer_, seed, &frame->depth);
}

}  // namespace camloc::sim
