// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// cameras.txt of COLMAP (colmap.github.io/cameras.html): CAMERA_ID MODEL WIDTH HEIGHT PARAMS. Its pixel (0.5, 0.5) is the centre of the
// first pixel, ours is (0, 0).
#include <array>
#include <string>
#include <vector>

#include "core/io/camera_file.h"
#include "core/io/text.h"

namespace camloc {

namespace {

constexpr double kPixelShift = 0.5;

/// The coefficients have our order: OpenCV's.
struct Model {
  const char* name;
  LensModel lens;
  int num_focal, num_coefficients;  ///< fx fy, or one for both; what follows the principal point
};
constexpr std::array<Model, 9> kModels = {{{"SIMPLE_PINHOLE", LensModel::kPinhole, 1, 0},
                                           {"PINHOLE", LensModel::kPinhole, 2, 0},
                                           {"SIMPLE_RADIAL", LensModel::kBrownConrady, 1, 1},
                                           {"RADIAL", LensModel::kBrownConrady, 1, 2},
                                           {"OPENCV", LensModel::kBrownConrady, 2, 4},
                                           {"FULL_OPENCV", LensModel::kBrownConrady, 2, 8},
                                           {"OPENCV_FISHEYE", LensModel::kEquidistant, 2, 4},
                                           {"SIMPLE_RADIAL_FISHEYE", LensModel::kEquidistant, 1, 1},
                                           {"RADIAL_FISHEYE", LensModel::kEquidistant, 1, 2}}};

const Model* model_named(const std::string& name) {
  for (const Model& model : kModels) {
    if (name == model.name) return &model;
  }
  return nullptr;
}

}  // namespace

Result<Intrinsics> colmap_intrinsics(const std::string& model_name, int width, int height, const std::vector<double>& parameters) {
  const Model* model = model_named(model_name);
  if (model == nullptr) {
    std::string known;
    for (const Model& one : kModels) known += (known.empty() ? "" : ", ") + std::string(one.name);
    return Status(ErrorCode::kUnsupported, "COLMAP's lens model " + in_quotes(model_name) + " is not read; " + known + " are");
  }
  const auto num_focal = static_cast<std::size_t>(model->num_focal);
  const std::size_t num_parameters = num_focal + 2 + static_cast<std::size_t>(model->num_coefficients);
  if (parameters.size() != num_parameters) {
    return Status(ErrorCode::kInvalid,
                  model_name + " has " + std::to_string(num_parameters) + " parameters, not " + std::to_string(parameters.size()));
  }
  Intrinsics k;
  k.width = width, k.height = height;
  k.fx = parameters[0], k.fy = parameters[num_focal - 1];
  k.cx = parameters[num_focal] - kPixelShift, k.cy = parameters[num_focal + 1] - kPixelShift;
  bool has_any = false, is_rational = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(model->num_coefficients); ++i) {
    const double value = parameters[num_focal + 2 + i];
    k.distortion[i] = value;
    has_any = has_any || value != 0;
    is_rational = is_rational || (i >= 5 && value != 0);
  }
  k.lens = has_any || model->lens == LensModel::kEquidistant ? model->lens : LensModel::kPinhole;
  if (is_rational) k.lens = LensModel::kRational;
  return k;
}

bool is_colmap_cameras(const std::string& text) {
  const std::vector<TextLine> lines = content_lines(text);
  if (lines.empty()) return false;
  const std::vector<std::string_view> fields = split_fields(lines.front().text, " \t");
  return fields.size() >= 7 && parse_int(fields[0]) && parse_int(fields[2]) && parse_int(fields[3]) &&
         fields[1].find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == std::string_view::npos;
}

Result<RgbdCamera> parse_camera_colmap(const std::string& text, const std::string& name, const CameraHints& hints) {
  const std::vector<TextLine> lines = content_lines(text);
  if (lines.size() > 1) {
    std::string ids;
    for (const TextLine& line : lines) ids += (ids.empty() ? "" : ", ") + std::string(split_fields(line.text, " \t").front());
    return Status(ErrorCode::kInvalid,
                  name + ": holds " + std::to_string(lines.size()) + " cameras (" + ids + "); leave one line in a copy of it");
  }
  const std::vector<std::string_view> fields = split_fields(lines.front().text, " \t");
  std::vector<double> parameters;
  for (std::size_t i = 4; i < fields.size(); ++i) {
    const std::optional<double> value = parse_double(fields[i]);
    if (!value) return line_error(name, lines.front().number, in_quotes(fields[i]) + " is not a number");
    parameters.push_back(*value);
  }
  const auto pixels = [&](std::size_t field) {
    const std::int64_t value = parse_int(fields[field]).value_or(0);
    return value > 0 && value <= 16384 ? static_cast<int>(value) : 0;  // the check of the camera names it
  };
  const auto color = colmap_intrinsics(std::string(fields[1]), pixels(2), pixels(3), parameters);
  if (!color.is_ok()) return color.status().with_context(name);
  RgbdCamera camera;
  camera.color = camera.depth = color.value();
  hints.note("camera " + std::string(fields[0]) +
             " of COLMAP: colour; its principal point is half a pixel less here, where pixel centres are whole numbers");
  hints.note("depth is taken as registered to colour: COLMAP knows no depth camera");
  return camera;
}

}  // namespace camloc
