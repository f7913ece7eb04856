// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A dense cloud from the depth images of a recording and its given poses: the reference where there is no scanner.
#pragma once

#include <cstdint>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/geometry/camera.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {

/// Every second depth pixel of every second row; those farther than 3.5 m or at depth edges, and voxels with fewer than three points,
/// are left out. Points are in the frame of the poses. Errors: of opening the recording; kInvalid
/// when no depth is left; kIo when stopped. Broken frames are skipped.
[[nodiscard]] Result<PointCloud> fuse_dense_cloud(const PosedFrames& frames, const RgbdCamera& camera, double voxel_m,
                                                  WorkObserver& observer = WorkObserver::nobody());

/// The points of one depth image in the frame of T_world_camera (the colour camera's pose).
void add_depth_image(const RgbdCamera& camera, ImageView<std::uint16_t> depth, const Rigid3& T_world_camera, CloudAccumulator* cloud);

}  // namespace camloc::mapping
