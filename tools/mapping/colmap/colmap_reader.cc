// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The reading half of colmap_model.h.
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "core/io/file_bytes.h"
#include "core/io/text.h"
#include "tools/mapping/colmap/colmap_model.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{2} << 30;  // a thousand images with ten thousand keypoints are 0.25 GB
constexpr std::size_t kNumImageFields = 9;                   // before the name
constexpr std::size_t kNumPointFields = 8;                   // before the track
constexpr double kMaxCoordinate = 1e9;

/// Takes the next line off the front, also an empty one: an image without keypoints has such.
bool take_line(std::string_view* text, TextLine* line) {
  if (text->empty()) return false;
  const std::size_t end = std::min(text->find('\n'), text->size());
  *line = {trimmed(text->substr(0, end)), line->number + 1};
  text->remove_prefix(std::min(end + 1, text->size()));
  return true;
}

/// Takes the next blank-separated field off the front; empty at the end.
std::string_view take_field(std::string_view* text) {
  const std::size_t begin = std::min(text->find_first_not_of(" \t"), text->size());
  const std::size_t end = std::min(text->find_first_of(" \t", begin), text->size());
  const std::string_view field = text->substr(begin, end - begin);
  text->remove_prefix(end);
  return field;
}

std::optional<double> take_finite(std::string_view* text) {
  const auto value = parse_double(take_field(text));
  return value && std::abs(*value) <= kMaxCoordinate ? value : std::nullopt;
}

template <typename Integer>
std::optional<Integer> take_id(std::string_view* text) {
  const std::string_view field = take_field(text);
  Integer value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (field.empty() || error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

template <std::size_t N>
std::optional<std::array<double, N>> take_finites(std::string_view* text) {
  std::array<double, N> values;
  for (double& value : values) {
    const auto field = take_finite(text);
    if (!field) return std::nullopt;
    value = *field;
  }
  return values;
}

Status read_cameras(const std::string& path, std::string_view text, ColmapModel* model) {
  std::unordered_set<std::uint32_t> ids;
  for (const TextLine& line : content_lines(text)) {
    std::string_view rest = line.text;
    const auto id = take_id<std::uint32_t>(&rest);
    const std::string lens(take_field(&rest));
    const auto width = take_id<std::uint16_t>(&rest), height = take_id<std::uint16_t>(&rest);
    if (!id || !width || !height || *width == 0 || *height == 0) {
      return line_error(path, line.number, "not CAMERA_ID MODEL WIDTH HEIGHT PARAMS: " + in_quotes(line.text));
    }
    if (!ids.insert(*id).second) return line_error(path, line.number, "camera " + std::to_string(*id) + " a second time");
    ColmapCamera camera{*id, lens, *width, *height, {}};
    while (!trimmed(rest).empty()) {
      const auto parameter = take_finite(&rest);
      if (!parameter) return line_error(path, line.number, "a camera parameter is no number: " + in_quotes(line.text));
      camera.parameters.push_back(*parameter);
    }
    model->cameras.push_back(std::move(camera));
  }
  return model->cameras.empty() ? Status(ErrorCode::kInvalid, path + ": holds no camera") : Status::ok();
}

using PointIndex = std::unordered_map<std::uint64_t, std::uint32_t>;

Status read_points(const std::string& path, std::string_view text, ColmapModel* model, PointIndex* index_of) {
  for (const TextLine& line : content_lines(text)) {
    std::string_view rest = line.text;
    const auto id = take_id<std::uint64_t>(&rest);
    const auto position = take_finites<3>(&rest);
    const auto red = take_id<std::uint8_t>(&rest), green = take_id<std::uint8_t>(&rest), blue = take_id<std::uint8_t>(&rest);
    const auto error = take_finite(&rest);
    const std::size_t num_track_fields = split_fields(rest, " \t").size();
    if (!id || !position || !red || !green || !blue || !error || num_track_fields % 2 != 0) {
      return line_error(path, line.number, "not POINT3D_ID X Y Z R G B ERROR and pairs IMAGE_ID POINT2D_IDX: " + in_quotes(line.text));
    }
    if (!index_of->emplace(*id, static_cast<std::uint32_t>(model->points.size())).second) {
      return line_error(path, line.number, "point " + std::to_string(*id) + " a second time");
    }
    model->points.push_back({*id, Eigen::Vector3d((*position)[0], (*position)[1], (*position)[2]), {*red, *green, *blue}});
  }
  return Status::ok();
}

std::optional<ColmapImage> parse_image(std::string_view line) {
  const auto id = take_id<std::uint32_t>(&line);
  const auto q = take_finites<4>(&line);
  const auto t = take_finites<3>(&line);
  const auto camera_id = take_id<std::uint32_t>(&line);
  const std::string name(trimmed(line));  // the rest: a name may hold blanks
  if (!id || !q || !t || !camera_id || name.empty()) return std::nullopt;
  const Eigen::Quaterniond rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) return std::nullopt;
  return ColmapImage{*id, *camera_id, {rotation.normalized(), Eigen::Vector3d((*t)[0], (*t)[1], (*t)[2])}, name, {}};
}

Status parse_observations(const std::string& path, const TextLine& line, const PointIndex& index_of, ColmapImage* image) {
  std::string_view rest = line.text;
  while (!trimmed(rest).empty()) {
    const auto pixel = take_finites<2>(&rest);
    const auto id = take_id<std::int64_t>(&rest);
    if (!pixel || !id)
      return line_error(path, line.number, "the keypoints of " + in_quotes(image->name) + " are not triples X Y POINT3D_ID");
    if (*id == -1) continue;
    const auto index = index_of.find(static_cast<std::uint64_t>(*id));
    if (index == index_of.end()) {
      return line_error(path, line.number,
                        in_quotes(image->name) + " observes point " + std::to_string(*id) + ", which points3D.txt does not have");
    }
    image->observations.push_back({(*pixel)[0], (*pixel)[1], index->second});
  }
  return Status::ok();
}

Status read_images(const std::string& path, std::string_view text, const PointIndex& index_of, ColmapModel* model) {
  std::unordered_set<std::uint32_t> camera_ids, ids;
  for (const ColmapCamera& camera : model->cameras) camera_ids.insert(camera.id);
  for (TextLine line; take_line(&text, &line);) {
    if (line.text.empty() || line.text[0] == '#') continue;
    auto image = parse_image(line.text);
    if (!image) return line_error(path, line.number, "not IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME: " + in_quotes(line.text));
    if (!ids.insert(image->id).second) return line_error(path, line.number, "image " + std::to_string(image->id) + " a second time");
    if (!camera_ids.contains(image->camera_id)) {
      return line_error(
          path, line.number,
          in_quotes(image->name) + " was taken by camera " + std::to_string(image->camera_id) + ", which cameras.txt does not have");
    }
    if (take_line(&text, &line)) {
      if (const Status read = parse_observations(path, line, index_of, &*image); !read.is_ok()) return read;
    }
    model->images.push_back(std::move(*image));
  }
  return model->images.empty() ? Status(ErrorCode::kInvalid, path + ": holds no image") : Status::ok();
}

Status check_folder(const std::string& folder) {
  std::error_code ignored;
  const std::filesystem::path path(folder);
  if (!std::filesystem::is_directory(path, ignored))
    return {ErrorCode::kNotFound, folder + ": no such folder; give the folder of a COLMAP model"};
  if (!std::filesystem::exists(path / "images.txt", ignored) && std::filesystem::exists(path / "images.bin", ignored)) {
    return {ErrorCode::kNotFound, folder + ": is a binary COLMAP model; convert it with 'colmap model_converter --input_path " + folder +
                                      " --output_path TEXT_DIR --output_type TXT'"};
  }
  return Status::ok();
}

}  // namespace

Result<ColmapModel> read_colmap_model(const std::string& folder) {
  if (const Status there = check_folder(folder); !there.is_ok()) return there;
  ColmapModel model;
  const auto file = [&folder](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  const auto cameras = read_file_text(file("cameras.txt"), kMaxFileBytes);
  if (!cameras) return cameras.status();
  if (const Status read = read_cameras(file("cameras.txt"), *cameras, &model); !read.is_ok()) return read;
  const auto points = read_file_text(file("points3D.txt"), kMaxFileBytes);
  if (!points) return points.status();
  PointIndex index_of;
  if (const Status read = read_points(file("points3D.txt"), *points, &model, &index_of); !read.is_ok()) return read;
  const auto images = read_file_text(file("images.txt"), kMaxFileBytes);
  if (!images) return images.status();
  if (const Status read = read_images(file("images.txt"), *images, index_of, &model); !read.is_ok()) return read;
  return model;
}

}  // namespace camloc::mapping
