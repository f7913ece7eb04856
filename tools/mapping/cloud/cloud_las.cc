// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// LAS ("LAS specification 1.4 - R15", ASPRS, 2019). Coordinates are 32-bit integers with a scale and an offset.
#include <algorithm>
#include <array>

#include "core/base/checked.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kMinHeaderBytes = 227, kHeaderBytes14 = 375;
constexpr std::array<std::size_t, 11> kRecordBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};  // by point format

struct Header {
  int point_format = 0;
  std::size_t record_bytes = 0;
  std::uint64_t points_offset = 0, num_points = 0;
  Eigen::Vector3d scale, offset;
};

template <typename T>
T number_at(std::span<const std::byte> bytes, std::size_t offset, ScalarType type) {
  return static_cast<T>(read_scalar(type, bytes.data() + offset));
}

Eigen::Vector3d vector_at(std::span<const std::byte> bytes, std::size_t offset) {
  const RecordAxes axes{{ScalarType::kFloat64, ScalarType::kFloat64, ScalarType::kFloat64}, {0, 8, 16}};
  return axes.point(bytes.data() + offset);
}

Result<Header> parse_header(const CloudInput& input, std::span<const std::byte> bytes) {
  const int minor = std::to_integer<int>(bytes[25]), format = std::to_integer<int>(bytes[104]);
  if (std::to_integer<int>(bytes[24]) != 1 || minor > 4) {
    return input.error(ErrorCode::kUnsupported, "LAS " + std::to_string(std::to_integer<int>(bytes[24])) + "." + std::to_string(minor) +
                                                    " is not read, 1.0 to 1.4 are");
  }
  if ((format & 0xC0) != 0) {
    return input.error(ErrorCode::kUnsupported,
                       "is compressed (LAZ), which is not read; convert it: pdal translate IN.laz OUT.las, or with CloudCompare");
  }
  if (format >= static_cast<int>(kRecordBytes.size())) {
    return input.error(ErrorCode::kUnsupported, "LAS point format " + std::to_string(format) + " is not read, 0 to 10 are");
  }
  Header header;
  header.point_format = format;
  header.record_bytes = number_at<std::size_t>(bytes, 105, ScalarType::kUint16);
  header.points_offset = number_at<std::uint64_t>(bytes, 96, ScalarType::kUint32);
  header.num_points = number_at<std::uint64_t>(bytes, 107, ScalarType::kUint32);
  if (minor == 4 && bytes.size() >= kHeaderBytes14) {
    const double num_points = read_scalar(ScalarType::kUint64, bytes.data() + 247);
    if (num_points > 0 && num_points < 1e18) header.num_points = static_cast<std::uint64_t>(num_points);
  }
  header.scale = vector_at(bytes, 131);
  header.offset = vector_at(bytes, 155);
  return header;
}

Status check(const CloudInput& input, const Header& header) {
  if (header.record_bytes < kRecordBytes[static_cast<std::size_t>(header.point_format)]) {
    return input.error(ErrorCode::kCorrupt, "records of " + std::to_string(header.record_bytes) +
                                                " bytes are too short for LAS point format " + std::to_string(header.point_format));
  }
  if (!header.scale.allFinite() || !header.offset.allFinite() || (header.scale.array() == 0).any()) {
    return input.error(ErrorCode::kCorrupt, "scale or offset of the coordinates are no numbers");
  }
  if (header.points_offset < kMinHeaderBytes) return input.error(ErrorCode::kCorrupt, "the points begin inside the header");
  const auto end = checked_end(header.points_offset, header.num_points, header.record_bytes);
  if (!end || *end > input.total()) {
    return input.truncated("the header promises " + std::to_string(header.num_points) + " points of " +
                           std::to_string(header.record_bytes) + " bytes, the file has " + std::to_string(input.total()) + " bytes");
  }
  return Status::ok();
}

bool is_withheld(int point_format, std::span<const std::byte> record) {
  const int flags = std::to_integer<int>(record[15]);
  return point_format < 6 ? (flags & 0x80) != 0 : (flags & 0x04) != 0;
}

/// Takes the input to the end of the records that it reads, at most kMaxRead bytes of them.
LasUnit read_unit(CloudInput* input, std::span<const std::byte> header_bytes, const Header& header) {
  const auto header_size = number_at<std::size_t>(header_bytes, 94, ScalarType::kUint16);
  const auto num_records = number_at<std::uint32_t>(header_bytes, 100, ScalarType::kUint32);
  if (num_records == 0 || header_size < kMinHeaderBytes || header_size >= header.points_offset) return {};
  if (!input->skip(header_size)) return {};
  const auto size = std::min<std::uint64_t>({header.points_offset - header_size, input->remaining(), CloudInput::kMaxRead});
  return las_unit(input->read(static_cast<std::size_t>(size)), num_records);
}

}  // namespace

Status read_las(CloudInput* input, CloudAccumulator* cloud) {
  const auto bytes = input->peek(kHeaderBytes14);
  if (bytes.size() < kMinHeaderBytes) return input->truncated("a LAS header has at least 227 bytes");
  const auto header = parse_header(*input, bytes);
  if (!header.is_ok()) return header.status();
  const Header& h = header.value();
  if (const Status checked = check(*input, h); !checked.is_ok()) return checked;
  const LasUnit unit = read_unit(input, bytes, h);
  if (unit.is_geographic && cloud->takes_declared_unit()) {
    return input->error(ErrorCode::kInvalid,
                        "x and y are longitude and latitude in degrees; project it: pdal translate IN.las OUT.las "
                        "reprojection --filters.reprojection.out_srs=EPSG:25832, or what your site uses");
  }
  double vertical = 1;  // units of z in units of x and y
  if (unit.horizontal_m > 0) cloud->declare_unit(unit.horizontal_m, unit.source);
  if (unit.horizontal_m > 0 && unit.vertical_m > 0 && cloud->takes_declared_unit()) vertical = unit.vertical_m / unit.horizontal_m;
  if (vertical != 1) cloud->note("heights have another unit than the plane, " + std::to_string(unit.vertical_m) + " m, as the file says");
  if (input->position() < h.points_offset && !input->skip(h.points_offset - input->position())) {
    return input->truncated("the points are missing");
  }
  const RecordAxes axes{{ScalarType::kInt32, ScalarType::kInt32, ScalarType::kInt32}, {0, 4, 8}};
  for (std::uint64_t i = 0; i < h.num_points; ++i) {
    const auto record = input->read(h.record_bytes);
    if (record.empty()) return input->truncated("it ends at point " + std::to_string(i) + " of " + std::to_string(h.num_points));
    if (is_withheld(h.point_format, record)) {
      cloud->add_invalid();
      continue;
    }
    Eigen::Vector3d p = axes.point(record.data()).cwiseProduct(h.scale) + h.offset;
    p.z() *= vertical;
    cloud->add(p);
  }
  return Status::ok();
}

}  // namespace camloc::mapping
