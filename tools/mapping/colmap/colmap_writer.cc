// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The writing half of colmap_model.h.
#include <charconv>
#include <filesystem>
#include <system_error>

#include "core/io/file_bytes.h"
#include "tools/common/text_format.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

/// " VALUE", the shortest text that reads back to the same bits, whatever the locale.
void append_value(double value, std::string* text) {
  char digits[40];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  *text += ' ';
  text->append(digits, end);
}

std::string format_cameras(const ColmapModel& model, const std::string& comment) {
  std::string text = "# " + comment + "\n# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (const ColmapCamera& camera : model.cameras) {
    text += std::to_string(camera.id) + " " + camera.model + " " + std::to_string(camera.width) + " " + std::to_string(camera.height);
    for (const double parameter : camera.parameters) append_value(parameter, &text);
    text += "\n";
  }
  return text;
}

std::string format_images(const ColmapModel& model, const std::string& comment) {
  std::string text = "# " + comment + "\n# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (const ColmapImage& image : model.images) {
    const Eigen::Quaterniond& q = image.T_camera_world.rotation;
    const Eigen::Vector3d& t = image.T_camera_world.translation;
    text += std::to_string(image.id);
    for (const double value : {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) append_value(value, &text);
    text += " " + std::to_string(image.camera_id) + " " + image.name + "\n";
    std::string keypoints;
    for (const ColmapObservation& seen : image.observations) {
      keypoints += tools::text_of(" %.3f %.3f %u", seen.u, seen.v, seen.point + 1);
    }
    text += (keypoints.empty() ? keypoints : keypoints.substr(1)) + "\n";
  }
  return text;
}

std::string format_points(const ColmapModel& model, const std::string& comment) {
  std::vector<std::string> track(model.points.size());
  for (const ColmapImage& image : model.images) {
    for (std::size_t i = 0; i < image.observations.size(); ++i) {
      track[image.observations[i].point] += " " + std::to_string(image.id) + " " + std::to_string(i);
    }
  }
  std::string text = "# " + comment + "\n# POINT3D_ID, X, Y, Z, R, G, B, ERROR (-1: not computed), TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    text += std::to_string(i + 1);
    for (const double value : model.points[i].position) append_value(value, &text);
    for (const std::uint8_t value : model.points[i].rgb) text += " " + std::to_string(value);
    text += " -1" + track[i] + "\n";
  }
  return text;
}

}  // namespace

ColmapCamera to_colmap(const Intrinsics& intrinsics, std::uint32_t id) {
  const auto& d = intrinsics.distortion;
  const double u = intrinsics.cx + kColmapPixelShift, v = intrinsics.cy + kColmapPixelShift;
  ColmapCamera camera{id, "PINHOLE", intrinsics.width, intrinsics.height, {intrinsics.fx, intrinsics.fy, u, v}};
  if (intrinsics.lens == LensModel::kEquidistant) {
    camera.model = "OPENCV_FISHEYE";
    camera.parameters.insert(camera.parameters.end(), d.begin(), d.begin() + 4);
  } else if (intrinsics.lens == LensModel::kRational) {
    camera.model = "FULL_OPENCV";
    camera.parameters.insert(camera.parameters.end(), d.begin(), d.end());
  } else if (intrinsics.lens == LensModel::kBrownConrady) {
    camera.model = d[4] == 0 ? "OPENCV" : "FULL_OPENCV";
    camera.parameters.insert(camera.parameters.end(), d.begin(), d.begin() + 4);
    if (d[4] != 0) camera.parameters.insert(camera.parameters.end(), {d[4], 0.0, 0.0, 0.0});
  }
  return camera;
}

Status write_colmap_model(const ColmapModel& model, const std::string& folder, const std::string& comment) {
  std::error_code error;
  const std::filesystem::path path(folder);
  if (std::filesystem::exists(path / "images.bin", error)) {
    return {ErrorCode::kInvalid, folder + ": holds a binary model, which COLMAP would read in place of a text one; give another folder"};
  }
  std::filesystem::create_directory(path, error);
  if (error) return {ErrorCode::kIo, folder + ": cannot make the folder: " + error.message()};
  const std::pair<const char*, std::string> files[] = {{"cameras.txt", format_cameras(model, comment)},
                                                       {"images.txt", format_images(model, comment)},
                                                       {"points3D.txt", format_points(model, comment)}};
  for (const auto& [name, text] : files) {
    if (const Status written = replace_file((path / name).string(), text); !written.is_ok()) return written;
  }
  return Status::ok();
}

}  // namespace camloc::mapping
