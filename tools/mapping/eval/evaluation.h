// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// How well a map agrees with a cloud of the same place: lays the landmarks onto the cloud, measures distances both ways, checks
// the scale, and says what to be careful about.
// The reference where there is no scanner: a dense cloud (dense_cloud.cc). What an evaluation says: a table for people, JSON for
// programs (eval_report.cc), warnings (eval_warnings.cc), pictures (eval_pictures.cc).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/io/image_file.h"
#include "core/map/map_view.h"
#include "tools/mapping/build/posed_frames.h"
#include "tools/mapping/cloud/cloud_registration.h"
#include "tools/mapping/cloud/point_cloud.h"
#include "tools/mapping/site/control_points.h"

namespace camloc::mapping {

enum class AlignStart { kAuto, kPoints, kTrajectory, kDatum, kNone, kSearch };

struct EvaluationOptions {
  AlignStart start = AlignStart::kAuto;  ///< kAuto: the first of points, trajectory, datum that is there, else kSearch
  bool has_icp = true;
  double trim = 0.9;
  double max_distance_m = 0.5;
  std::uint32_t min_observations = 2;
};

/// The same camera at the same moment, in the map and in the frame of the cloud.
struct PosePair {
  Rigid3 T_map_camera, T_reference_camera;
};

struct EvaluationInput {
  const MapView* map = nullptr;
  const PointCloud* cloud = nullptr;
  std::vector<ControlPair> points;  ///< may be empty
  std::vector<PosePair> poses;      ///< may be empty
};

/// How sure a search is: mean distances of the landmarks to the cloud, none counting more than max_distance_m, for the start that
/// was chosen and for the best of the others.
struct SearchOutcome {
  double score_m = 0, rival_score_m = 0;
  bool is_identity = false;  ///< the map's own frame taken as the cloud's
  std::size_t num_starts = 0;
};

struct PointResidual {
  std::string name;
  double sigma_m = 0;
  Eigen::Vector3d aligned_m, final_m;  ///< map minus cloud, cloud's axes, aligned by the points, and at the end
};

struct Evaluation {
  std::uint64_t num_landmarks = 0, num_used = 0, num_keyframes = 0;  ///< num_used: with enough observations
  AlignStart start = AlignStart::kNone;                              ///< the one that was used
  std::optional<SearchOutcome> search;                               ///< of kSearch
  Rigid3 T_cloud_map_start, T_cloud_map;                             ///< absolute: with the cloud's origin
  std::optional<Registration> registration;                          ///< nothing when there was no ICP
  double moved_m = 0, moved_rad = 0;                                 ///< by ICP: the middle of the landmarks, and the rotation
  std::optional<double> scale, sigma_scale;                          ///< of a similarity by ICP: 1 expected
  std::optional<double> points_scale, poses_scale;                   ///< by Umeyama over control points, over camera positions
  /// Twice what residuals of that size do to a scale over points that lie so far apart, at least 0.01.
  double points_scale_tolerance = 0.01, poses_scale_tolerance = 0.01;
  std::vector<PointResidual> residuals;
  double max_distance_m = 0.5;  ///< farther from the cloud is outside of it
  CloudDistances distances;
  std::vector<Eigen::Vector3d> landmarks_m, keyframes_m;  ///< for pictures; relative to the cloud's origin, aligned
  std::vector<Rigid3> T_cloud_keyframe;
};

/// Errors: kInvalid when the map has no landmarks with enough
/// observations, a start was asked for that the input does not give, the cloud seems to be in millimetres; kNotFound
/// when map and cloud do not overlap; kIo when stopped.
[[nodiscard]] Result<Evaluation> evaluate_map(const EvaluationInput& input, const EvaluationOptions& options,
                                              WorkObserver& observer = WorkObserver::nobody());

/// Name of a start, as in the report.
[[nodiscard]] const char* describe(AlignStart start);

/// Every second depth pixel of every second row; those farther than 3.5 m or at depth edges, and voxels with fewer than three points,
/// are left out. Points are in the frame of the poses. Errors: of opening the recording; kInvalid
/// when no depth is left; kIo when stopped. Broken frames are skipped.
[[nodiscard]] Result<PointCloud> fuse_dense_cloud(const PosedFrames& frames, const RgbdCamera& camera, double voxel_m,
                                                  WorkObserver& observer = WorkObserver::nobody());

/// The points of one depth image in the frame of T_world_camera (the colour camera's pose).
void add_depth_image(const RgbdCamera& camera, ImageView<std::uint16_t> depth, const Rigid3& T_world_camera, CloudAccumulator* cloud);

struct EvalSummary {
  std::string map_path, cloud_name;
  std::uint64_t num_read = 0, num_invalid = 0, num_points = 0;  ///< of the cloud
  double unit_m = 1;                                            ///< of the cloud
  std::string unit_from;                                        ///< who says so
  std::vector<std::string> cloud_notes, cloud_warnings;         ///< of reading it
  double voxel_m = 0;
  std::uint32_t min_observations = 0;
  Evaluation evaluation;
  std::vector<std::string> files;  ///< that were written
  double seconds = 0;
};

[[nodiscard]] std::string format_table(const EvalSummary& summary);
[[nodiscard]] std::string format_json(const EvalSummary& summary);

/// What to be careful about: one line each, that begins with a word in capitals: SCALE, VOLUME, UNIT, POINTS, START, OVERLAP,
/// SLIDING, ICP.
[[nodiscard]] std::vector<std::string> warnings_of(const Evaluation& evaluation);

/// Landmark-to-point distances in steps of 2.5 mm up to 10 cm and the rest, with mean, median and 95th percentile.
[[nodiscard]] ColorImage draw_histogram(const CloudDistances& distances, const std::string& title);

/// Landmarks by distance (dark blue: on the cloud, yellow: 10 cm and more) over the cloud in grey, with the keyframes. From
/// above, where what is over the cameras' heads is cut off as in a floor plan, or from the side. Up is where the cameras' up is
/// on average, corrected to what is within 30 degrees: the cloud's z axis, or else a direction across walls and floors.
enum class CloudView { kTop, kSide };
[[nodiscard]] ColorImage draw_cloud_view(const Evaluation& evaluation, const PointCloud& cloud, CloudView view, const std::string& title);

}  // namespace camloc::mapping
