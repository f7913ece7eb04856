// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// PLY (Turk, "The PLY polygon file format", 1994).
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/base/checked.h"
#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr int kMaxHeaderLines = 1000;
constexpr std::size_t kMaxProperties = 256;

struct Property {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::optional<ScalarType> list_count_type;  ///< set: a list, its length comes first
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  /// Bytes without what is in the lists.
  [[nodiscard]] std::size_t min_bytes() const {
    std::size_t bytes = 0;
    for (const Property& p : properties) bytes += scalar_bytes(p.list_count_type.value_or(p.type));
    return bytes;
  }
};

struct Header {
  bool is_ascii = false, is_big_endian = false;
  std::vector<Element> elements;
};

std::optional<ScalarType> type_named(std::string_view name) {
  static constexpr std::pair<std::string_view, ScalarType> kNames[] = {
      {"char", ScalarType::kInt8},       {"int8", ScalarType::kInt8},      {"uchar", ScalarType::kUint8},
      {"uint8", ScalarType::kUint8},     {"short", ScalarType::kInt16},    {"int16", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},   {"uint16", ScalarType::kUint16},  {"int", ScalarType::kInt32},
      {"int32", ScalarType::kInt32},     {"uint", ScalarType::kUint32},    {"uint32", ScalarType::kUint32},
      {"int64", ScalarType::kInt64},     {"uint64", ScalarType::kUint64},  {"float", ScalarType::kFloat32},
      {"float32", ScalarType::kFloat32}, {"double", ScalarType::kFloat64}, {"float64", ScalarType::kFloat64}};
  for (const auto& [known, type] : kNames)
    if (name == known) return type;
  return std::nullopt;
}

std::optional<Property> parse_property(const std::vector<std::string_view>& fields) {
  if (fields.size() == 3) {
    const auto type = type_named(fields[1]);
    if (type) return Property{std::string(fields[2]), *type, std::nullopt};
  } else if (fields.size() == 5 && fields[1] == "list") {
    const auto count_type = type_named(fields[2]), type = type_named(fields[3]);
    if (count_type && type && *count_type < ScalarType::kFloat32) return Property{std::string(fields[4]), *type, *count_type};
  }
  return std::nullopt;
}

/// False where the line makes no sense.
bool parse_header_line(std::string_view line, Header* header, bool* has_format) {
  const auto fields = split_fields(line, " \t");
  if (fields.empty() || fields[0] == "comment" || fields[0] == "obj_info") return true;
  if (fields[0] == "format") {
    if (fields.size() != 3) return false;
    header->is_ascii = fields[1] == "ascii";
    header->is_big_endian = fields[1] == "binary_big_endian";
    *has_format = header->is_ascii || header->is_big_endian || fields[1] == "binary_little_endian";
    return *has_format;
  }
  if (fields[0] == "element") {
    const auto count = fields.size() == 3 ? parse_int(fields[2]) : std::nullopt;
    if (!count || *count < 0) return false;
    header->elements.push_back({std::string(fields[1]), static_cast<std::uint64_t>(*count), {}});
    return true;
  }
  if (fields[0] != "property" || header->elements.empty()) return false;
  auto property = parse_property(fields);
  auto& properties = header->elements.back().properties;
  if (!property || properties.size() >= kMaxProperties) return false;
  properties.push_back(std::move(*property));
  return true;
}

Result<Header> read_header(CloudInput* input) {
  Header header;
  bool has_format = false;
  for (int number = 1; number <= kMaxHeaderLines; ++number) {
    const auto line = input->read_line();
    if (!line) return input->truncated("its header has no end");
    const std::string_view text = trimmed(*line);
    if (number == 1) continue;  // "ply"
    if (text == "end_header") {
      if (!has_format) return input->error(ErrorCode::kCorrupt, "the PLY header has no format line");
      return header;
    }
    if (!parse_header_line(text, &header, &has_format)) return line_error(input->name(), number, "no PLY header line: " + in_quotes(text));
  }
  return input->error(ErrorCode::kCorrupt, "the PLY header has more than " + std::to_string(kMaxHeaderLines) + " lines");
}

/// Positions of x, y, z among the properties; they are no lists.
std::optional<std::array<std::size_t, 3>> find_axes(const Element& element) {
  constexpr std::string_view kNames[] = {"x", "y", "z"};
  std::array<std::size_t, 3> axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                    [&](const Property& p) { return p.name == kNames[axis] && !p.list_count_type; });
    if (found == element.properties.end()) return std::nullopt;
    axes[axis] = static_cast<std::size_t>(found - element.properties.begin());
  }
  return axes;
}

Status cut_off(const CloudInput& input, const Element& element, std::uint64_t done) {
  return input.truncated("the header promises " + std::to_string(element.count) + " of element '" + element.name + "', the file has " +
                         std::to_string(done));
}

/// One binary element, its lists skipped; `values` gets the scalars. False where the file ends.
bool read_binary_element(CloudInput* input, const Element& element, bool is_big_endian, std::vector<double>* values) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const Property& p = element.properties[i];
    const ScalarType first = p.list_count_type.value_or(p.type);
    const auto bytes = input->read(scalar_bytes(first));
    if (bytes.empty()) return false;
    const double value = read_scalar(first, bytes.data(), is_big_endian);
    (*values)[i] = value;
    if (!p.list_count_type) continue;
    if (!(value >= 0 && value < 1e15) || !input->skip(static_cast<std::uint64_t>(value) * scalar_bytes(p.type))) return false;
  }
  return true;
}

/// The scalars of one element in text, a line each.
bool parse_ascii_element(std::string_view line, const Element& element, std::vector<double>* values) {
  const auto fields = split_fields(line, " \t");
  std::size_t next = 0;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (next >= fields.size()) return false;
    const auto value = parse_double(fields[next++]);
    if (!value) return false;
    (*values)[i] = *value;
    if (!element.properties[i].list_count_type) continue;
    if (!(*value >= 0 && *value <= static_cast<double>(fields.size() - next))) return false;
    next += static_cast<std::size_t>(*value);
  }
  return true;
}

/// Adds the points of vertices, whose coordinates stand at `axes`; other elements have none and are skipped.
Status read_element(CloudInput* input, const Element& element, const Header& header, const std::optional<std::array<std::size_t, 3>>& axes,
                    CloudAccumulator* cloud) {
  if (element.properties.empty()) return Status::ok();
  std::vector<double> values(element.properties.size());
  for (std::uint64_t i = 0; i < element.count;) {
    if (header.is_ascii) {
      const auto line = input->read_line();
      if (!line) return cut_off(*input, element, i);
      if (axes && trimmed(*line).empty()) continue;
      if (axes && !parse_ascii_element(*line, element, &values)) {
        return input->error(ErrorCode::kCorrupt, "vertex " + std::to_string(i) + " is no line of " + std::to_string(values.size()) +
                                                     " numbers: " + in_quotes(trimmed(*line)));
      }
    } else if (!read_binary_element(input, element, header.is_big_endian, &values)) {
      return cut_off(*input, element, i);
    }
    if (axes) cloud->add({values[(*axes)[0]], values[(*axes)[1]], values[(*axes)[2]]});
    ++i;
  }
  return Status::ok();
}

}  // namespace

Status read_ply(CloudInput* input, CloudAccumulator* cloud) {
  const auto header = read_header(input);
  if (!header.is_ok()) return header.status();
  for (const Element& element : header.value().elements) {
    // Also a line of text takes a byte a value.
    const std::uint64_t min_bytes = header.value().is_ascii ? 2 * element.properties.size() : element.min_bytes();
    const auto bytes = checked_multiply(element.count, min_bytes);
    if (!bytes || *bytes > input->remaining() + 1) {
      return input->truncated("the header promises " + std::to_string(element.count) + " of element '" + element.name +
                              "', which do not fit into " + std::to_string(input->remaining()) + " bytes");
    }
    const bool is_vertex = element.name == "vertex";
    const auto axes = is_vertex ? find_axes(element) : std::nullopt;
    if (is_vertex && !axes) return input->error(ErrorCode::kCorrupt, "its vertices have no properties x, y and z");
    if (const Status read = read_element(input, element, header.value(), axes, cloud); !read.is_ok() || is_vertex) return read;
  }
  return input->error(ErrorCode::kCorrupt, "has no element 'vertex'");
}

}  // namespace camloc::mapping
