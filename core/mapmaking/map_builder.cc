// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Each frame becomes a view (features with depth), each view goes to the fusion, which makes landmarks of what the views share,
// and to the consistency, which measures how well the given poses agree. finish() hands both to map_assembly.
#include "core/mapmaking/map_builder.h"

#include <string>

#include "core/mapmaking/landmark_fusion.h"
#include "core/mapmaking/pose_consistency.h"

namespace camloc {
namespace {

PoseConsistencyOptions consistency_options(const MapBuildOptions& options) {
  PoseConsistencyOptions consistency;
  consistency.max_features = options.orb.num_features;
  return consistency;
}

}  // namespace

struct MapBuilder::Impl {
  Impl(const RgbdCamera& rgbd_camera, const MapBuildOptions& build_options)
      : camera(rgbd_camera),
        options(build_options),
        extractor(camera, options.orb),
        fusion(camera.color, camera.depth_noise, options.orb),
        consistency(camera, PyramidLevels(options.orb.scale_factor, options.orb.num_levels), consistency_options(options)) {}

  RgbdCamera camera;
  MapBuildOptions options;
  FrameExtractor extractor;
  LandmarkFusion fusion;
  PoseConsistency consistency;
  MapBuildReport report;
};

MapBuilder::MapBuilder(const RgbdCamera& camera, const MapBuildOptions& options) : impl_(std::make_unique<Impl>(camera, options)) {}
MapBuilder::~MapBuilder() = default;

Status MapBuilder::add_frame(const Frame& frame, const Rigid3& T_map_camera) {
  Status status = impl_->extractor.check(frame);
  if (status.is_ok() && !(T_map_camera.translation.allFinite() && T_map_camera.rotation.coeffs().allFinite()))
    status = {ErrorCode::kInvalid, "frame " + std::to_string(frame.sequence) + ": pose is not finite"};
  if (!status.is_ok()) return status;
  FrameFeatures view;
  impl_->extractor.extract(frame, &view);
  view.T_map_camera = T_map_camera;
  add_view(view);
  return Status::ok();
}

void MapBuilder::add_view(const FrameFeatures& view) {
  impl_->fusion.add_view(view);
  impl_->consistency.add_view(view);
  ++impl_->report.num_frames;
}

MapBuildReport MapBuilder::progress() const {
  MapBuildReport report = impl_->report;
  report.num_observations = impl_->fusion.num_observations();
  report.num_landmarks_before = static_cast<std::uint32_t>(impl_->fusion.num_landmarks());
  return report;
}

Result<MapData> MapBuilder::finish(MapBuildReport* report) {
  Impl& self = *impl_;
  MapParts parts;
  parts.camera = self.camera;
  parts.landmarks = self.fusion.landmarks(&parts.support);
  parts.views = self.fusion.views();
  parts.poses = self.fusion.poses();
  const PoseConsistencyEstimate consistency = self.consistency.estimate();
  parts.pose_sigma_m = consistency.sigma_m;
  parts.pose_sigma_rad = consistency.sigma_rad;
  self.report.num_observations = self.fusion.num_observations();
  self.report.num_consistency_pairs = consistency.num_pairs;
  Result<MapData> map = assemble_map(parts, self.options, &self.report);
  if (map.is_ok() && report != nullptr) *report = self.report;
  return map;
}

}  // namespace camloc
