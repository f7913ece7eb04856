// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {
namespace {

constexpr double kNotedStepM = 0.002, kMaxStepM = 0.01;  // a scanner's noise is a few millimetres

struct Reader {
  Status (*read)(CloudInput*, CloudAccumulator*);
};

std::string extension_of(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_text(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](char c) { return (c >= ' ' && c != '\x7f') || c == '\t' || c == '\r' || c == '\n'; });
}

Result<Reader> choose_reader(CloudInput* input) {
  const auto bytes = input->peek(512);
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string extension = extension_of(input->name());
  if (start.empty()) return input->error(ErrorCode::kInvalid, "is empty");
  if (start.starts_with("ASTM-E57")) {
    return input->error(
        ErrorCode::kUnsupported,
        "E57 is not read; convert it: CloudCompare -O IN.e57 -C_EXPORT_FMT PLY -SAVE_CLOUDS, or pdal translate IN.e57 OUT.ply");
  }
  if (extension == ".laz") {
    return input->error(ErrorCode::kUnsupported,
                        "LAZ is not read; convert it: pdal translate IN.laz OUT.las, or with CloudCompare to LAS or PLY");
  }
  if (start.starts_with("LASF")) return Reader{read_las};
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return Reader{read_ply};
  if (start.starts_with("# .PCD") || start.starts_with("VERSION") || extension == ".pcd") return Reader{read_pcd};
  if (is_text(start) && is_ptx(start)) return Reader{read_ptx};
  if (extension == ".ptx") return input->error(ErrorCode::kInvalid, "is no PTX: columns, rows, position, axes and a 4x4 matrix come first");
  if (is_text(start) && extension != ".ply" && extension != ".las") return Reader{read_text_cloud};
  return input->error(ErrorCode::kUnsupported,
                      "is no kind of point cloud that is known here; PLY, PCD, LAS, PTX and text tables (XYZ, PTS, CSV) are read");
}

/// Coordinates of a country in 32-bit floats are stairs; nothing measured on them is worth anything.
Status check_steps(const CloudInput& input, PointCloud* cloud) {
  Eigen::Index axis = 0;
  const double step_m = cloud->step_m.maxCoeff(&axis);
  if (step_m < kNotedStepM) return Status::ok();
  char what[200];
  std::snprintf(
      what, sizeof(what),
      "coordinates around %c = %.0f hold no more than 32-bit floats do: steps of %.2g m. Export it with double precision, or shifted to "
      "an origin near the site",
      "xyz"[axis], cloud -> origin_m[axis] / cloud -> unit_m, step_m);
  if (step_m > kMaxStepM) return input.error(ErrorCode::kInvalid, what);
  cloud->warnings.push_back(std::string("STEPS: ") + what);
  return Status::ok();
}

template <typename T>
double load(const std::byte* bytes, bool is_swapped) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (is_swapped) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<T>(raw));
}

}  // namespace

std::size_t scalar_bytes(ScalarType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

double read_scalar(ScalarType type, const std::byte* bytes, bool is_big_endian) {
  const bool is_swapped = is_big_endian != (std::endian::native == std::endian::big);
  switch (type) {
    case ScalarType::kInt8: return load<std::int8_t>(bytes, is_swapped);
    case ScalarType::kUint8: return load<std::uint8_t>(bytes, is_swapped);
    case ScalarType::kInt16: return load<std::int16_t>(bytes, is_swapped);
    case ScalarType::kUint16: return load<std::uint16_t>(bytes, is_swapped);
    case ScalarType::kInt32: return load<std::int32_t>(bytes, is_swapped);
    case ScalarType::kUint32: return load<std::uint32_t>(bytes, is_swapped);
    case ScalarType::kInt64: return load<std::int64_t>(bytes, is_swapped);
    case ScalarType::kUint64: return load<std::uint64_t>(bytes, is_swapped);
    case ScalarType::kFloat32: return load<float>(bytes, is_swapped);
    case ScalarType::kFloat64: return load<double>(bytes, is_swapped);
  }
  return 0;
}

std::optional<Eigen::Vector3d> parse_point(const std::vector<std::string_view>& fields, const std::array<std::size_t, 3>& columns) {
  Eigen::Vector3d p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = columns[axis] < fields.size() ? parse_double(fields[columns[axis]]) : std::nullopt;
    if (!value) return std::nullopt;
    p[static_cast<Eigen::Index>(axis)] = *value;
  }
  return p;
}

Result<PointCloud> read_cloud(std::istream& stream, const std::string& name, const CloudOptions& options, WorkObserver& observer) {
  CloudInput input(stream, name, observer);
  const auto reader = choose_reader(&input);
  if (!reader.is_ok()) return reader.status();
  CloudAccumulator accumulator(options);
  const Status read = reader->read(&input, &accumulator);
  if (input.is_stopped()) return input.truncated("");
  if (!read.is_ok()) return read;
  PointCloud cloud = accumulator.finish();
  if (cloud.num_read == 0) return input.error(ErrorCode::kInvalid, "holds no points");
  if (cloud.points_m.empty()) {
    return input.error(ErrorCode::kInvalid, "none of its " + std::to_string(cloud.num_read) + " points is valid (not finite, or withheld)");
  }
  if (Status steps = check_steps(input, &cloud); !steps.is_ok()) return steps;
  return cloud;
}

Result<PointCloud> read_cloud(const std::string& path, const CloudOptions& options, WorkObserver& observer) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {ErrorCode::kNotFound, path + ": no such file"};
  if (std::filesystem::is_directory(path, error)) return {ErrorCode::kInvalid, path + ": is a folder; give a point cloud file"};
  if (!std::filesystem::is_regular_file(path, error)) return {ErrorCode::kInvalid, path + ": is no regular file"};
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return {ErrorCode::kIo, path + ": cannot be read; check its permissions"};
  return read_cloud(stream, path, options, observer);
}

}  // namespace camloc::mapping
