// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the localizer tests share: a map of a part of the sample room, made from frames 0, 3, 6 .. 90 of its path, frames
// to localize with their true poses, and ways to spoil them.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/symmetric_system.h"
#include "core/localize/localizer.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "core/mapmaking/map_builder.h"
#include "drivers/sample_source.h"
#include "tests/map/synthetic_map.h"

namespace camloc::testing {

inline constexpr std::uint64_t kMappedFrames = 91;  ///< frames 0 .. 90 of the path lie within the map
inline constexpr std::uint64_t kMapStep = 3;        ///< every third was mapped; the others are queries
inline constexpr std::int64_t kFrameNs = 33'333'333;

/// A map on disk for as long as this lives.
struct MapOnDisk {
  explicit MapOnDisk(const MapData& data) : path(folder.file("map.cmap")) {
    if (!write_map(data, path).is_ok()) return;
    Result<MapView> opened = MapView::open(path);
    if (opened) view = std::make_unique<MapView>(std::move(opened).value());
  }
  TemporaryFolder folder;
  std::string path;
  std::unique_ptr<MapView> view;
};

class SampleWorld {
 public:
  /// Made once in a process: half a second.
  static const SampleWorld& get() {
    static const SampleWorld world;
    return world;
  }
  [[nodiscard]] const RgbdCamera& camera() const { return camera_; }
  [[nodiscard]] const MapData& data() const { return data_; }
  [[nodiscard]] const MapView& map() const { return *on_disk_->view; }

  /// Frame `index` of the path, stamped at 30 Hz.
  [[nodiscard]] FrameBuffer frame(std::uint64_t index) const { return frame(index, index); }
  /// What the camera sees at `index` of the path, stamped as number `sequence` of a recording.
  [[nodiscard]] FrameBuffer frame(std::uint64_t index, std::uint64_t sequence) const {
    FrameBuffer buffer;
    buffer.sequence = sequence;
    buffer.stamp_ns = static_cast<std::int64_t>(sequence) * kFrameNs;
    room_.render(camera_, sample_pose(index), &buffer);
    return buffer;
  }

 private:
  SampleWorld() : camera_(sample_camera(320, 240)) {
    MapBuilder builder(camera_, MapBuildOptions{});
    for (std::uint64_t i = 0; i < kMappedFrames; i += kMapStep) {
      if (!builder.add_frame(frame(i).view(), sample_pose(i)).is_ok()) return;
    }
    MapBuildReport report;
    Result<MapData> built = builder.finish(&report);
    if (built) data_ = std::move(built).value();
    on_disk_ = std::make_unique<MapOnDisk>(data_);
  }

  RgbdCamera camera_;
  SampleRoom room_;
  MapData data_;
  std::unique_ptr<MapOnDisk> on_disk_;
};

/// Squared Mahalanobis distance of the truth: chi-square with 6 degrees of freedom for an honest covariance.
inline double nees(const Localization& result, const Rigid3& T_map_camera_true) {
  const Vector6d error = pose_error(T_map_camera_true, result.T_map_camera);
  return squared_mahalanobis(error, result.covariance);
}
inline constexpr double kNeesLimit = 22.46;  ///< exceeded by 0.1 % of honest poses

/// All that a result says, without padding and without stage times: equal bits mean equal results.
inline std::vector<std::uint64_t> bits_of(const Localization& r) {
  std::vector<std::uint64_t> bits = {r.sequence,
                                     static_cast<std::uint64_t>(r.stamp_ns),
                                     static_cast<std::uint64_t>(r.state),
                                     static_cast<std::uint64_t>(r.reason),
                                     r.has_pose,
                                     static_cast<std::uint64_t>(r.quality),
                                     r.is_tracked,
                                     r.num_features,
                                     r.evidence.num_visible,
                                     r.evidence.num_matches,
                                     r.evidence.num_inliers,
                                     r.reset_counter};
  const auto add = [&bits](double value) { bits.push_back(std::bit_cast<std::uint64_t>(value)); };
  for (const double value : r.T_map_camera.rotation.coeffs()) add(value);
  for (const double value : r.T_map_camera.translation) add(value);
  for (const double value : r.covariance.reshaped()) add(value);
  for (const double value : {r.evidence.inlier_ratio(), r.evidence.spread, r.standing.margin, r.evidence.focal_scale,
                             r.evidence.depth_agreement, r.evidence.map_depth_agreement, r.jump_m})
    add(value);
  return bits;
}

inline bool is_finite(const Localization& r) {
  bool is_ok = r.T_map_camera.rotation.coeffs().allFinite() && r.T_map_camera.translation.allFinite() && r.covariance.allFinite();
  for (const double value : {r.evidence.inlier_ratio(), r.evidence.spread, r.standing.margin, r.evidence.focal_scale,
                             r.evidence.depth_agreement, r.evidence.map_depth_agreement, r.jump_m}) {
    is_ok = is_ok && std::isfinite(value);
  }
  return is_ok;
}

/// The sample map with a second copy, `offset_m` away, of the landmarks that are wanted, seen from keyframes that are copied, too.
inline MapData with_copy(const Eigen::Vector3d& offset_m,
                         const std::function<bool(std::uint32_t landmark, const Eigen::Vector3d& p_map)>& is_wanted) {
  MapData map = SampleWorld::get().data();
  const auto num_landmarks = static_cast<std::uint32_t>(map.landmarks.size());
  std::vector<std::uint32_t> copy_of(num_landmarks, UINT32_MAX);
  for (std::uint32_t i = 0; i < num_landmarks; ++i) {
    if (!is_wanted(i, map.landmarks[i].position_m.cast<double>())) continue;
    copy_of[i] = static_cast<std::uint32_t>(map.landmarks.size());
    MapLandmark copy = map.landmarks[i];
    copy.position_m += offset_m.cast<float>();
    map.landmarks.push_back(copy);
  }
  const std::size_t num_keyframes = map.keyframes.size();
  for (std::size_t k = 0; k < num_keyframes; ++k) {
    MapKeyframe copy = map.keyframes[k];
    copy.T_map_camera.translation += offset_m;
    copy.landmarks.clear();
    for (const std::uint32_t landmark : map.keyframes[k].landmarks) {
      if (copy_of[landmark] != UINT32_MAX) copy.landmarks.push_back(copy_of[landmark]);
    }
    map.keyframes.push_back(copy);
  }
  add_inverted_file(&map);
  return map;
}

/// The room in a mirror, a place that looks as real as the room but is another one: the camera's principal point is the
/// centre, so image and depth stay true to each other.
inline void mirror(FrameBuffer* frame) {
  for (int y = 0; y < frame->gray.height; ++y) std::reverse(frame->gray.row(y), frame->gray.row(y) + frame->gray.width);
  for (int y = 0; y < frame->depth.height; ++y) std::reverse(frame->depth.row(y), frame->depth.row(y) + frame->depth.width);
}

/// Cuts image and depth into tiles and deals them anew.
inline void shuffle_tiles(int tile_px, std::uint32_t seed, FrameBuffer* frame) {
  const FrameBuffer original = *frame;
  const int columns = frame->gray.width / tile_px, rows = frame->gray.height / tile_px;
  std::vector<int> order(static_cast<std::size_t>(columns * rows));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  for (int tile = 0; tile < columns * rows; ++tile) {
    const int from = order[static_cast<std::size_t>(tile)];
    for (int y = 0; y < tile_px; ++y) {
      for (int x = 0; x < tile_px; ++x) {
        const int to_x = tile % columns * tile_px + x, to_y = tile / columns * tile_px + y;
        const int from_x = from % columns * tile_px + x, from_y = from / columns * tile_px + y;
        frame->gray.at(to_x, to_y) = original.gray.at(from_x, from_y);
        frame->depth.at(to_x, to_y) = original.depth.at(from_x, from_y);
      }
    }
  }
}

/// Noise of a plain sensor: grey levels, and depth as camera.depth_noise says.
inline void add_noise(const RgbdCamera& camera, double sigma_gray, std::uint32_t seed, FrameBuffer* frame) {
  Random random(seed);
  const auto gaussian = [&random] {  // twelve uniform numbers: the same on every machine
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += random.uniform(0, 1);
    return sum;
  };
  for (auto& p : frame->gray.pixels) p = static_cast<std::uint8_t>(std::clamp(p + sigma_gray * gaussian(), 0.0, 255.0));
  for (auto& p : frame->depth.pixels) {
    const double z = p * camera.depth_unit_m;
    p = static_cast<std::uint16_t>(std::clamp((z + camera.depth_noise.sigma_m(z) * gaussian()) / camera.depth_unit_m, 1.0, 65534.0));
  }
}

}  // namespace camloc::testing
