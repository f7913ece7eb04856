// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/colmap/map_export.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "core/base/order_statistics.h"
#include "core/io/sequence.h"
#include "tools/common/map_points.h"
#include "tools/common/text_format.h"
#include "tools/mapping/picture/point_raster.h"
#include "tools/mapping/site/map_up.h"

namespace camloc::mapping {
namespace {

Rigid3 T_out_map(const MapView& map, const ExportOptions& options) {
  return options.use_wcs && map.info().wcs ? map.info().wcs->T_wcs_map : Rigid3{};
}

/// One colour a landmark: the ramp over the 2nd to 98th percentile of heights, or over the logarithm of the observations.
std::vector<Rgb> landmark_colors(const MapView& map, const std::vector<Eigen::Vector3d>& positions, PointColoring coloring) {
  const std::span<const Rgb> ramp = value_ramp();
  std::vector<double> values;
  double low = 0, high = std::log(255.0);
  if (coloring == PointColoring::kHeight) {
    const Eigen::Vector3d up = up_axis(map);
    for (const Eigen::Vector3d& p : positions) values.push_back(up.dot(p));
    std::tie(low, high) = trimmed_range(values, 50);
  } else {
    for (const auto& landmark : map.landmarks()) values.push_back(std::log(std::max<double>(1, landmark.num_observations)));
  }
  std::vector<Rgb> colors;
  for (const double value : values) {
    const double fraction = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) : 0.5;
    colors.push_back(ramp[static_cast<std::size_t>(std::lround(fraction * static_cast<double>(ramp.size() - 1)))]);
  }
  return colors;
}

/// The bytes of a number, lowest first, whatever the machine.
template <typename Bits>
void append_bits(Bits bits, std::string* bytes) {
  for (std::size_t i = 0; i < sizeof bits; ++i) *bytes += static_cast<char>(static_cast<unsigned char>(bits >> (8 * i)));
}

void append_float(double value, std::string* bytes) { append_bits(std::bit_cast<std::uint32_t>(static_cast<float>(value)), bytes); }

std::string ply_header(const MapView& map, const ExportOptions& options) {
  const std::string type = options.use_wcs ? "double" : "float";
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + describe_export(map, options) +
                     "\ncomment nx ny nz: mean direction from the landmark to the cameras that saw it\nelement vertex " +
                     std::to_string(map.landmarks().size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += "property " + type + " " + axis + "\n";
  for (const char* axis : {"nx", "ny", "nz"}) text += std::string("property float ") + axis + "\n";
  for (const char* color : {"red", "green", "blue"}) text += std::string("property uchar ") + color + "\n";
  return text + "property uchar num_observations\nproperty float position_sigma_m\nend_header\n";
}

bool is_inside(const Intrinsics& intrinsics, const Eigen::Vector2d& pixel) {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= intrinsics.width - 0.5 && pixel.y() <= intrinsics.height - 0.5;
}

ColmapImage make_image(const MapView& map, std::uint32_t keyframe, const std::vector<Eigen::Vector3d>& positions, const Rigid3& T_out,
                       std::vector<std::uint32_t>* buffer) {
  const Intrinsics& color = map.info().camera.color;
  const Rigid3 T_camera_map = map.keyframe_pose(keyframe).inverse();
  ColmapImage image{keyframe + 1, 1, T_camera_map * T_out.inverse(), tools::text_of("keyframe-%06u", keyframe), {}};
  const std::size_t count = map.keyframe_landmarks(keyframe, *buffer);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t landmark = (*buffer)[i];
    if (landmark >= positions.size()) continue;
    const Eigen::Vector3d p = T_camera_map * positions[landmark];
    if (p.z() <= 0) continue;
    const Eigen::Vector2d pixel = color.project(p);
    // A lens model folds points far outside back into the image; those do not come back to where they started.
    if (!is_inside(color, pixel) || !color.is_invertible_at(pixel)) continue;
    if ((color.undistort(pixel) - p.head<2>() / p.z()).norm() > 1e-3) continue;
    image.observations.push_back({pixel.x() + kColmapPixelShift, pixel.y() + kColmapPixelShift, landmark});
  }
  return image;
}

}  // namespace

Status check_export(const MapView& map, const ExportOptions& options) {
  if (!options.use_wcs || map.info().wcs) return Status::ok();
  return {ErrorCode::kInvalid, map.info().path + ": has no site coordinates; leave --wcs out, or fit a datum with 'camloc map georef'"};
}

std::string describe_export(const MapView& map, const ExportOptions& options) {
  return "camloc map " + tools::printable(map.info().name) + tools::text_of(" (%016llx), metres, ", tools::llu(map.info().map_id)) +
         (options.use_wcs ? "coordinates of the site (wcs)" : "coordinates of the map");
}

std::string format_ply(const MapView& map, const ExportOptions& options) {
  const std::vector<Eigen::Vector3d> positions = tools::landmark_positions(map);
  const std::vector<Rgb> colors = landmark_colors(map, positions, options.coloring);
  const Rigid3 T_out = T_out_map(map, options);
  std::string bytes = ply_header(map, options);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto& landmark = map.landmarks()[i];
    const Eigen::Vector3d position = T_out * positions[i];
    const Eigen::Vector3d direction = T_out.rotation * MapView::direction(landmark).cast<double>();
    for (const double value : position) {
      if (options.use_wcs)
        append_bits(std::bit_cast<std::uint64_t>(value), &bytes);
      else
        append_float(value, &bytes);
    }
    for (const double value : direction) append_float(value, &bytes);
    for (const std::uint8_t value : colors[i]) append_bits(value, &bytes);
    append_bits(landmark.num_observations, &bytes);
    append_float(1e-3 * landmark.position_sigma_mm, &bytes);
  }
  return bytes;
}

ColmapModel make_colmap_model(const MapView& map, const ExportOptions& options) {
  const std::vector<Eigen::Vector3d> positions = tools::landmark_positions(map);
  const std::vector<Rgb> colors = landmark_colors(map, positions, options.coloring);
  const Rigid3 T_out = T_out_map(map, options);
  ColmapModel model;
  model.cameras.push_back(to_colmap(map.info().camera.color, 1));
  for (std::size_t i = 0; i < positions.size(); ++i) model.points.push_back({i + 1, T_out * positions[i], colors[i]});
  std::vector<std::uint32_t> buffer(map.info().max_keyframe_landmarks);
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) model.images.push_back(make_image(map, k, positions, T_out, &buffer));
  return model;
}

std::string format_tum(const MapView& map, const ExportOptions& options) {
  constexpr std::int64_t kNsPerKeyframe = 1'000'000'000;
  const Rigid3 T_out = T_out_map(map, options);
  std::string text = "# " + describe_export(map, options) +
                     "\n# timestamp tx ty tz qx qy qz qw of the colour camera; a map keeps no stamps: timestamp = index of the keyframe\n";
  for (std::uint32_t k = 0; k < map.keyframes().size(); ++k) {
    text += format_tum_line(kNsPerKeyframe * k, T_out * map.keyframe_pose(k)) + "\n";
  }
  return text;
}

}  // namespace camloc::mapping
