// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Read merge_maps() first. Keyframes of B are registered in A (map_registration), B is bent until they fit (map_alignment), landmarks
// of B that are one of A's are merged into it (landmark_merging), and the union is assembled as any map is.
#include "core/merge/map_merging.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/map/map_unpack.h"

namespace camloc {
namespace {

constexpr float kConfirmedWorth = 2;  // what a landmark counts more that was seen again on another day: it lasts

constexpr double kMaxFocalRatio = 1.25;  // beyond, features of the two cameras lie on different pyramid levels

Status check_pair(const MapData& a, const MapData& b) {
  if (std::abs(a.orb_scale_factor - b.orb_scale_factor) > 1e-4F || a.orb_num_levels != b.orb_num_levels) {
    char text[256];
    std::snprintf(text, sizeof text, "the maps have different image pyramids: %u levels of factor %.3f and %u of %.3f; build both alike",
                  a.orb_num_levels, static_cast<double>(a.orb_scale_factor), b.orb_num_levels, static_cast<double>(b.orb_scale_factor));
    return {ErrorCode::kInvalid, text};
  }
  const double ratio = a.camera.color.mean_focal_px() / b.camera.color.mean_focal_px();
  if (!(ratio < kMaxFocalRatio && ratio > 1 / kMaxFocalRatio)) {
    char text[1024];
    std::snprintf(text, sizeof text,
                  "cameras '%.40s' and '%.40s' do not fit: focal lengths %.0f and %.0f px; use recordings of like cameras",
                  a.camera.name.c_str(), b.camera.name.c_str(), a.camera.color.mean_focal_px(), b.camera.color.mean_focal_px());
    return {ErrorCode::kInvalid, text};
  }
  if (b.landmarks.empty() || b.keyframes.empty()) return {ErrorCode::kInvalid, "the second map is empty"};
  return Status::ok();
}

/// Reference distances as A's camera would have measured them.
void adopt_focal_length(const RgbdCamera& camera, MapData* b) {
  const auto ratio = static_cast<float>(camera.color.mean_focal_px() / b->camera.color.mean_focal_px());
  for (MapLandmark& landmark : b->landmarks) {
    landmark.min_reference_m *= ratio;
    landmark.max_reference_m *= ratio;
  }
}

std::uint8_t cell_of(const Intrinsics& color, const Rigid3& T_camera_map, const Eigen::Vector3f& p_map) {
  const Eigen::Vector3d p = T_camera_map * p_map.cast<double>();
  if (!(p.z() > 0.01)) return 0;
  const Eigen::Vector2d pixel = color.project(p);
  const double column = std::clamp(pixel.x() * kCellColumns / color.width, 0.0, kCellColumns - 1.0);
  const double row = std::clamp(pixel.y() * kCellRows / color.height, 0.0, kCellRows - 1.0);
  return static_cast<std::uint8_t>(static_cast<int>(row) * kCellColumns + static_cast<int>(column));
}

/// Everything that is known after both maps are in one frame.
struct Union {
  MapParts parts;
  std::vector<std::vector<ViewObservation>> views;
  std::vector<Rigid3> poses;
};

void add_views(const MapData& map, const std::vector<std::uint32_t>& new_index, Union* all) {
  for (const MapKeyframe& keyframe : map.keyframes) {
    const Rigid3 T_camera_map = keyframe.T_map_camera.inverse();
    auto& view = all->views.emplace_back();
    for (const std::uint32_t i : keyframe.landmarks)
      view.push_back({new_index[i], cell_of(map.camera.color, T_camera_map, map.landmarks[i].position_m)});
    all->poses.push_back(keyframe.T_map_camera);
  }
}

Union unite(const MapData& a, const MapData& b, MapMergeReport* report) {
  Union all;
  MapParts& parts = all.parts;
  parts.landmarks = a.landmarks;
  std::vector<std::uint32_t> index_a(a.landmarks.size()), index_b(b.landmarks.size());
  for (std::uint32_t i = 0; i < a.landmarks.size(); ++i) {
    index_a[i] = i;
    parts.support.push_back(guess_support(a.landmarks[i]));
  }
  const std::vector<SameLandmark> same = find_same_landmarks(a, b);
  std::size_t next_same = 0;
  for (std::uint32_t i = 0; i < b.landmarks.size(); ++i) {
    const std::vector<std::uint32_t> support = guess_support(b.landmarks[i]);
    if (next_same < same.size() && same[next_same].b == i) {
      index_b[i] = same[next_same++].a;
      report->num_appearances += merge_landmark(b.landmarks[i], support, &parts.landmarks[index_b[i]], &parts.support[index_b[i]]);
      continue;
    }
    index_b[i] = static_cast<std::uint32_t>(parts.landmarks.size());
    parts.landmarks.push_back(b.landmarks[i]);
    parts.support.push_back(support);
  }
  report->num_fused = static_cast<std::uint32_t>(same.size());
  report->num_added = static_cast<std::uint32_t>(b.landmarks.size() - same.size());
  add_views(a, index_a, &all);
  add_views(b, index_b, &all);
  for (const MapLandmark& landmark : parts.landmarks) parts.worth.push_back(static_cast<float>(landmark.num_observations));
  for (const SameLandmark& confirmed : same) parts.worth[confirmed.a] *= kConfirmedWorth;
  return all;
}

/// T_wcs_a = T_wcs_b * T_b_a, with the uncertainty of both.
WcsDatum carried_over(const WcsDatum& T_wcs_b, const MapAlignmentReport& alignment) {
  // pose_error() of the inverse: the same turn the other way, seen from b.
  const Rigid3 T_b_a = alignment.T_a_b.inverse();
  const Eigen::Matrix3d R = T_b_a.rotation.toRotationMatrix();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = -R;
  J.topRightCorner<3, 3>() = -R * cross_matrix(alignment.T_a_b.translation);
  J.bottomRightCorner<3, 3>() = -R;
  const PoseWithCovariance T_wcs_a = to_wcs(T_wcs_b, {T_b_a, J * alignment.covariance * J.transpose()});
  return {T_wcs_a.pose, T_wcs_a.covariance};
}

}  // namespace

Result<MapData> merge_maps(const MapView& a, const MapData& b, const MapMergeOptions& options, WorkObserver& observer,
                           MapMergeReport* report) {
  const MapData first = unpack_map(a);
  if (const Status fits = check_pair(first, b); !fits.is_ok()) return fits;
  report->num_keyframes_a = static_cast<std::uint32_t>(first.keyframes.size());
  report->num_keyframes_b = static_cast<std::uint32_t>(b.keyframes.size());
  report->num_landmarks_a = static_cast<std::uint32_t>(first.landmarks.size());
  report->num_landmarks_b = static_cast<std::uint32_t>(b.landmarks.size());

  const auto fixes = register_map(a, first, b, observer, &report->registration);
  if (!fixes.is_ok()) return fixes.status();
  report->num_localized = static_cast<std::uint32_t>(fixes.value().size());
  MapData second = b;
  adopt_focal_length(first.camera, &second);
  report->alignment = align_map(fixes.value(), &second);

  Union all = unite(first, second, report);
  all.parts.camera = first.camera;
  all.parts.views = all.views;
  all.parts.poses = all.poses;
  // What the maps disagree by between views is no better than what they disagree by with each other.
  const double per_axis = 1 / std::sqrt(3.0);
  all.parts.pose_sigma_m = std::max({first.pose_sigma_m, b.pose_sigma_m, report->alignment.residual_m * per_axis});
  all.parts.pose_sigma_rad = std::max({first.pose_sigma_rad, b.pose_sigma_rad, report->alignment.residual_rad * per_axis});
  MapBuildOptions build = options.map;
  build.orb.scale_factor = first.orb_scale_factor;
  build.orb.num_levels = static_cast<int>(first.orb_num_levels);
  if (!observer.on_progress("choosing landmarks and keyframes, training words ...")) return {ErrorCode::kUnavailable, "interrupted"};
  Result<MapData> merged = assemble_map(all.parts, build, &report->map);
  if (!merged.is_ok()) return merged.status();
  merged->name = first.name;
  merged->wcs = first.wcs;
  if (!first.wcs && b.wcs) {
    merged->wcs = carried_over(*b.wcs, report->alignment);
    report->is_datum_from_b = true;
  }
  return merged;
}

}  // namespace camloc
