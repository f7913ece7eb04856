// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map from posed RGB-D frames: features with depth become observations, observations of one point become a landmark,
// the views that together see all landmarks become the keyframes, the landmarks' descriptors become a vocabulary.
// Offline; allocates as it goes.
#pragma once

#include <memory>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/geometry/camera.h"
#include "core/map/map_data.h"
#include "core/mapmaking/map_assembly.h"
#include "core/registration/frame_features.h"

namespace camloc {

class MapBuilder {
 public:
  MapBuilder(const RgbdCamera& camera, const MapBuildOptions& options);
  ~MapBuilder();

  /// One view with its given pose. kInvalid when an image size does not fit the camera or the pose is not finite: the
  /// frame is skipped, the builder goes on. A frame without depth is skipped, too.
  [[nodiscard]] Status add_frame(const Frame& frame, const Rigid3& T_map_camera);
  /// The same for a view whose features were extracted before (FrameExtractor, with the options' OrbOptions), pose included.
  void add_view(const FrameFeatures& view);
  /// Counts so far (frames, observations, landmarks before pruning), for a progress display.
  [[nodiscard]] MapBuildReport progress() const;
  /// Fuses, covers, prunes to the budget, trains the words. kInvalid when no landmark is left.
  [[nodiscard]] Result<MapData> finish(MapBuildReport* report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
