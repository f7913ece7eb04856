// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// PCD 0.7, the Point Cloud Library's own format. Its compressed variant holds the fields one after the other, packed with LZF
// (Lehmann's LibLZF: literal runs and back references).
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/base/checked.h"
#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr int kMaxHeaderLines = 100;
constexpr std::size_t kMaxFields = 256, kMaxFieldCount = 4096;
constexpr std::uint64_t kMaxLzfExpansion = 100;  // a reference of 3 bytes stands for at most 264
constexpr std::uint64_t kMaxUnpackedBytes = std::uint64_t{8} << 30;

enum class Encoding { kAscii, kBinary, kCompressed };

struct Field {
  std::string name;
  char type = 'F';
  std::size_t size = 4, count = 1;
  [[nodiscard]] std::size_t bytes() const { return size * count; }
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t num_points = 0;
  Encoding encoding = Encoding::kAscii;
};

/// Where x, y and z are: among the fields, in a record, and among the columns of a line.
struct Axes {
  std::array<std::size_t, 3> field{}, column{};
  RecordAxes record;
};

std::optional<ScalarType> type_of(const Field& field) {
  switch (field.size) {
    case 1: return field.type == 'I' ? ScalarType::kInt8 : ScalarType::kUint8;
    case 2: return field.type == 'I' ? ScalarType::kInt16 : ScalarType::kUint16;
    case 4: return field.type == 'F' ? ScalarType::kFloat32 : field.type == 'I' ? ScalarType::kInt32 : ScalarType::kUint32;
    case 8: return field.type == 'F' ? ScalarType::kFloat64 : field.type == 'I' ? ScalarType::kInt64 : ScalarType::kUint64;
    default: return std::nullopt;
  }
}

/// SIZE, TYPE and COUNT have an entry for each of FIELDS.
bool parse_field_line(const std::vector<std::string_view>& words, std::vector<Field>* fields) {
  if (words.size() != fields->size() + 1) return false;
  for (std::size_t i = 0; i < fields->size(); ++i) {
    Field& field = (*fields)[i];
    if (words[0] == "TYPE") {
      field.type = words[i + 1].front();
      if (words[i + 1].size() != 1 || std::string_view("FIU").find(field.type) == std::string_view::npos) return false;
      continue;
    }
    const auto value = parse_int(words[i + 1]);
    if (!value || *value < 1 || *value > static_cast<std::int64_t>(kMaxFieldCount)) return false;
    (words[0] == "SIZE" ? field.size : field.count) = static_cast<std::size_t>(*value);
  }
  return true;
}

/// False where the line makes no sense. `num_points` is WIDTH times HEIGHT until POINTS says it.
bool parse_header_line(const std::vector<std::string_view>& words, Header* header, std::uint64_t* width) {
  const std::string_view key = words[0];
  if (key == "VERSION" || key == "VIEWPOINT") return true;
  if (key == "FIELDS") {
    if (words.size() > kMaxFields + 1) return false;
    for (std::size_t i = 1; i < words.size(); ++i) header->fields.push_back({std::string(words[i])});
    return true;
  }
  if (key == "SIZE" || key == "TYPE" || key == "COUNT") return parse_field_line(words, &header->fields);
  if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
    const auto value = words.size() == 2 ? parse_int(words[1]) : std::nullopt;
    if (!value || *value < 0) return false;
    const auto count = static_cast<std::uint64_t>(*value);
    if (key == "WIDTH") *width = count;
    header->num_points = key == "HEIGHT" ? checked_multiply(*width, count).value_or(~std::uint64_t{0}) : count;
    return true;
  }
  if (key != "DATA" || words.size() != 2) return false;
  header->encoding = words[1] == "ascii" ? Encoding::kAscii : words[1] == "binary" ? Encoding::kBinary : Encoding::kCompressed;
  return words[1] == "ascii" || words[1] == "binary" || words[1] == "binary_compressed";
}

Result<Header> read_header(CloudInput* input) {
  Header header;
  std::uint64_t width = 0;
  for (int number = 1; number <= kMaxHeaderLines; ++number) {
    const auto line = input->read_line();
    if (!line) return input->truncated("its header has no DATA line");
    const std::string_view text = trimmed(*line);
    if (text.empty() || text.front() == '#') continue;
    const auto words = split_fields(text, " \t");
    if (!parse_header_line(words, &header, &width)) return line_error(input->name(), number, "no PCD header line: " + in_quotes(text));
    if (words[0] == "DATA") return header;
  }
  return input->error(ErrorCode::kCorrupt, "the PCD header has more than " + std::to_string(kMaxHeaderLines) + " lines");
}

std::optional<Axes> find_axes(const std::vector<Field>& fields) {
  constexpr std::string_view kNames[] = {"x", "y", "z"};
  Axes axes;
  std::size_t num_found = 0, byte = 0, column = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto type = type_of(fields[i]);
      if (fields[i].name != kNames[axis] || !type) continue;
      axes.field[axis] = i, axes.record.byte[axis] = byte, axes.column[axis] = column, axes.record.type[axis] = *type;
      ++num_found;
    }
    byte += fields[i].bytes();
    column += fields[i].count;
  }
  return num_found == 3 ? std::optional(axes) : std::nullopt;
}

Status cut_off(const CloudInput& input, const Header& header, std::uint64_t done) {
  return input.truncated("the header promises " + std::to_string(header.num_points) + " points, the file has " + std::to_string(done));
}

Status read_ascii(CloudInput* input, const Header& header, const Axes& axes, CloudAccumulator* cloud) {
  for (std::uint64_t i = 0; i < header.num_points;) {
    const auto line = input->read_line();
    if (!line) return cut_off(*input, header, i);
    const auto fields = split_fields(*line, " \t");
    if (fields.empty()) continue;
    const auto p = parse_point(fields, axes.column);
    if (!p) return input->error(ErrorCode::kCorrupt, "point " + std::to_string(i) + " is no line of numbers: " + in_quotes(trimmed(*line)));
    cloud->add(*p);
    ++i;
  }
  return Status::ok();
}

Status read_binary(CloudInput* input, const Header& header, const Axes& axes, std::size_t record_bytes, CloudAccumulator* cloud) {
  const auto bytes = checked_multiply(header.num_points, record_bytes);
  if (!bytes || *bytes > input->remaining()) return cut_off(*input, header, input->remaining() / record_bytes);
  for (std::uint64_t i = 0; i < header.num_points; ++i) {
    const auto record = input->read(record_bytes);
    if (record.empty()) return cut_off(*input, header, i);
    cloud->add(axes.record.point(record.data()));
  }
  return Status::ok();
}

/// False where the packed bytes make no sense or do not fill `unpacked` exactly.
bool unpack_lzf(std::span<const std::byte> packed, std::span<std::byte> unpacked) {
  std::size_t in = 0, out = 0;
  while (in < packed.size()) {
    const std::size_t control = std::to_integer<std::size_t>(packed[in++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > packed.size() - in || length > unpacked.size() - out) return false;
      std::copy_n(packed.data() + in, length, unpacked.data() + out);
      in += length, out += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (length == 9) {
      if (in >= packed.size()) return false;
      length += std::to_integer<std::size_t>(packed[in++]);
    }
    if (in >= packed.size()) return false;
    const std::size_t distance = ((control & 31) << 8) + std::to_integer<std::size_t>(packed[in++]) + 1;
    if (distance > out || length > unpacked.size() - out) return false;
    for (std::size_t i = 0; i < length; ++i, ++out) unpacked[out] = unpacked[out - distance];  // may overlap itself
  }
  return out == unpacked.size();
}

Status read_compressed(CloudInput* input, const Header& header, const Axes& axes, std::size_t record_bytes, CloudAccumulator* cloud) {
  const auto sizes = input->read(8);
  if (sizes.empty()) return input->truncated("the sizes of the compressed data are missing");
  const auto packed_bytes = static_cast<std::uint64_t>(read_scalar(ScalarType::kUint32, sizes.data()));
  const auto unpacked_bytes = static_cast<std::uint64_t>(read_scalar(ScalarType::kUint32, sizes.data() + 4));
  if (packed_bytes > input->remaining()) return input->truncated("the compressed data are shorter than they say");
  if (checked_multiply(header.num_points, record_bytes) != unpacked_bytes || unpacked_bytes > kMaxLzfExpansion * packed_bytes ||
      unpacked_bytes > kMaxUnpackedBytes) {
    return input->error(ErrorCode::kCorrupt, "the compressed data unpack to " + std::to_string(unpacked_bytes) + " bytes, which is not " +
                                                 std::to_string(header.num_points) + " points");
  }
  std::vector<std::byte> packed(packed_bytes), unpacked(unpacked_bytes);
  for (std::size_t done = 0; done < packed.size();) {
    const auto part = input->read(std::min(CloudInput::kMaxRead, packed.size() - done));
    if (part.empty()) return input->truncated("the compressed data end early");
    std::copy(part.begin(), part.end(), packed.begin() + static_cast<std::ptrdiff_t>(done));
    done += part.size();
  }
  if (!unpack_lzf(packed, unpacked)) return input->error(ErrorCode::kCorrupt, "the compressed data are damaged");
  // Field by field: the column of a field begins after those of the fields before it.
  RecordAxes at = axes.record;
  for (std::size_t axis = 0; axis < 3; ++axis) at.byte[axis] *= header.num_points;
  for (std::uint64_t i = 0; i < header.num_points; ++i) {
    cloud->add(at.point(unpacked.data()));
    for (std::size_t axis = 0; axis < 3; ++axis) at.byte[axis] += header.fields[axes.field[axis]].bytes();
  }
  return Status::ok();
}

}  // namespace

Status read_pcd(CloudInput* input, CloudAccumulator* cloud) {
  const auto header = read_header(input);
  if (!header.is_ok()) return header.status();
  const auto axes = find_axes(header.value().fields);
  if (!axes) return input->error(ErrorCode::kCorrupt, "has no fields x, y and z of a known type");
  std::size_t record_bytes = 0;
  for (const Field& field : header.value().fields) record_bytes += field.bytes();
  if (record_bytes > CloudInput::kMaxRead)
    return input->error(ErrorCode::kCorrupt, "a point of " + std::to_string(record_bytes) + " bytes is absurd");
  switch (header.value().encoding) {
    case Encoding::kAscii: return read_ascii(input, header.value(), *axes, cloud);
    case Encoding::kBinary: return read_binary(input, header.value(), *axes, record_bytes, cloud);
    case Encoding::kCompressed: return read_compressed(input, header.value(), *axes, record_bytes, cloud);
  }
  return Status::ok();
}

}  // namespace camloc::mapping
