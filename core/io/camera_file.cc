// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A parser for each kind (camera_KIND.cc, one line in the table below) makes a camera of a text, and here it gets a name and is checked.
// Writing is here, too: always TOML, numbers so short that they read back as the same bits.
#include "core/io/camera_file.h"

#include <charconv>
#include <filesystem>

#include "core/io/file_bytes.h"
#include "core/io/text.h"

namespace camloc {

namespace {

constexpr std::size_t kMaxFileBytes = 1 << 20;

bool starts_with(const std::string& text, std::string_view begin) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return first != std::string::npos && std::string_view(text).substr(first).starts_with(begin);
}

/// TOML begins with a [table] or key = value, YAML with a directive, "---" or key: value.
bool is_toml(const std::string& text) {
  const std::vector<TextLine> lines = content_lines(text);
  if (lines.empty()) return false;
  const std::string_view first = lines[0].text;
  const std::size_t mark = first.find_first_of("=:");
  return first[0] == '[' || (mark != std::string_view::npos && first[mark] == '=');
}

bool is_yaml(const std::string& text) {
  const std::vector<TextLine> lines = content_lines(text);
  return !lines.empty() &&
         (lines[0].text[0] == '%' || lines[0].text.starts_with("---") || lines[0].text.find(':') != std::string_view::npos);
}

/// A kind of calibration file. The first whose test says yes reads it.
struct Reader {
  bool (*is_kind)(const std::string& text);
  Result<RgbdCamera> (*parse)(const std::string& text, const std::string& name, const CameraHints& hints);
};
constexpr Reader kReaders[] = {
    {[](const std::string& text) { return starts_with(text, "<"); }, parse_camera_xml},
    {[](const std::string& text) { return starts_with(text, "{"); }, parse_camera_json},
    {is_colmap_cameras, parse_camera_colmap},
    {is_toml, [](const std::string& text, const std::string& name, const CameraHints&) { return parse_camera_toml(text, name); }},
    {is_yaml, parse_camera_yaml},
};

Result<RgbdCamera> parse_any(const std::string& text, const std::string& name, const CameraHints& hints) {
  for (const Reader& reader : kReaders) {
    if (reader.is_kind(text)) return reader.parse(text, name, hints);
  }
  return Status(ErrorCode::kInvalid,
                name +
                    ": no camera file; expected TOML as in config/cameras, YAML of kalibr, ROS or OpenCV, XML of OpenCV, JSON "
                    "of Open3D or an SDK, or cameras.txt of COLMAP");
}

/// Shortest text that reads back as the same double.
std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  std::string result(text, end);
  if (result.find_first_of(".e") == std::string::npos) result += ".0";
  return result;
}

template <typename Numbers>
std::string list(const Numbers& numbers, std::size_t count) {
  std::string result = "[";
  for (std::size_t i = 0; i < count; ++i) result += (i == 0 ? "" : ", ") + number(numbers[i]);
  return result + "]";
}

std::string format_intrinsics(const Intrinsics& k) {
  std::string result = "width = " + std::to_string(k.width) + "    # pixels\nheight = " + std::to_string(k.height) + "\n";
  result += "fx = " + number(k.fx) + "    # focal lengths, pixels\nfy = " + number(k.fy) + "\n";
  result += "cx = " + number(k.cx) + "    # principal point, pixels; pixel centres are at integers\ncy = " + number(k.cy) + "\n";
  switch (k.lens) {
    case LensModel::kPinhole: return result + "lens = \"pinhole\"\n";
    case LensModel::kBrownConrady:
      return result + "lens = \"brown_conrady\"\ndistortion = " + list(k.distortion, 5) + "    # k1 k2 p1 p2 k3\n";
    case LensModel::kRational:
      return result + "lens = \"rational\"\ndistortion = " + list(k.distortion, 8) + "    # k1 k2 p1 p2 k3 k4 k5 k6\n";
    case LensModel::kEquidistant: return result + "lens = \"equidistant\"\ndistortion = " + list(k.distortion, 4) + "    # k1 k2 k3 k4\n";
  }
  return result;
}

}  // namespace

Result<RgbdCamera> parse_camera(const std::string& text, const std::string& name, const CameraHints& hints) {
  Result<RgbdCamera> camera = parse_any(text, name, hints);
  if (!camera) return camera;
  if (camera->name.empty()) camera->name = std::filesystem::path(name).stem().string();
  if (Status status = camera->validate(); !status) return status.with_context(name);
  return camera;
}

Result<RgbdCamera> read_camera_file(const std::string& path, const CameraHints& hints) {
  Result<std::string> text = read_file_text(path, kMaxFileBytes);
  if (!text) return text.status();
  return parse_camera(*text, path, hints);
}

std::string format_camera_toml(const RgbdCamera& camera, const std::vector<std::string>& comments) {
  std::string result;
  for (const std::string& comment : comments) result += "# " + comment + "\n";
  result += "name = " + in_double_quotes(camera.name) + "\n\n[color]\n" + format_intrinsics(camera.color) + "\n[depth]\n";
  result += std::string("registered = ") + (camera.is_depth_registered ? "true" : "false") + "    # depth pixels are colour pixels\n";
  if (!camera.is_depth_registered) result += format_intrinsics(camera.depth);
  result += "unit_m = " + number(camera.depth_unit_m) + "    # metres per raw unit\n";
  result += "min_m = " + number(camera.min_depth_m) + "\nmax_m = " + number(camera.max_depth_m) + "\n";
  result += "noise_constant_m = " + number(camera.depth_noise.constant_m) + "    # sigma(z) = constant + quadratic * z^2\n";
  result += "noise_quadratic_per_m = " + number(camera.depth_noise.quadratic_per_m) + "\n";
  const Eigen::Vector3d& t = camera.T_color_depth.translation;
  const Eigen::Quaterniond& q = camera.T_color_depth.rotation;
  if (!camera.is_depth_registered || t != Eigen::Vector3d::Zero() || q.coeffs() != Eigen::Quaterniond::Identity().coeffs()) {
    result += "\n[extrinsics]    # T_color_depth: p_color = R(rotation) * p_depth + translation\n";
    result += "translation_m = " + list(t, 3) + "\nrotation_wxyz = " + list(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()), 4) + "\n";
  }
  result += std::string("\n[poses]\ncamera = ") + (camera.poses_are_of_depth_camera ? "\"depth\"" : "\"color\"") +
            "    # which camera recorded poses belong to\n";
  return result;
}

}  // namespace camloc
