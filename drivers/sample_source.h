// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// sample://: images of a textured room seen by a camera on a closed path, generated, with exact depth and known
// poses. For trying the pipe without a device or data, and for tests; no model of a real sensor (see camloc-sim).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "drivers/frame_source.h"
#include "drivers/source_url.h"

namespace camloc {

/// Pinhole with the field of view of a Kinect, depth registered, 1 mm units.
[[nodiscard]] RgbdCamera sample_camera(int width, int height);
/// T_map_camera of frame `index`; the path closes after kSamplePeriod frames. `map` has z up, its origin on the floor.
[[nodiscard]] Rigid3 sample_pose(std::uint64_t index);
inline constexpr std::uint64_t kSamplePeriod = 600;

/// The room's surfaces, painted once (1.5 MB); the same on every run.
class SampleRoom {
 public:
  SampleRoom();
  /// Grey and depth as seen from T_map_camera inside the room.
  void render(const RgbdCamera& camera, const Rigid3& T_map_camera, FrameBuffer* frame) const;

 private:
  static constexpr int kTextureSize = 512;
  [[nodiscard]] std::uint8_t shade(int face, float u, float v) const;
  std::array<std::vector<std::uint8_t>, 6> faces_;  // kTextureSize^2 each
};

/// Options: rate_hz (30; 0 = as fast as possible with stamps of 30 Hz), frames (0 = endless), width, height.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_sample_source(const SourceUrl& url, const FrameSourceOptions& options);

}  // namespace camloc
