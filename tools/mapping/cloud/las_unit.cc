// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The unit of a LAS file, from its GeoKeyDirectoryTag (GeoTIFF 1.1: OGC 19-008r4, 2019) or its WKT record (OGC 01-009, 18-010). An
// EPSG code alone says nothing here: that would take the EPSG database.
#include <cctype>
#include <cmath>
#include <string>
#include <vector>

#include "core/io/text.h"
#include "tools/mapping/cloud/cloud_input.h"

namespace camloc::mapping {
namespace {

constexpr std::size_t kRecordHead = 54;
constexpr std::uint16_t kGeoKeys = 34735, kGeoDoubles = 34736, kWkt = 2112;
constexpr std::uint16_t kModelType = 1024, kGeographicModel = 2;
constexpr std::uint16_t kLinearUnits = 3076, kLinearUnitSize = 3077, kVerticalUnits = 4099;

struct KnownUnit {
  std::uint16_t code;  ///< EPSG
  double metres;
  const char* name;
};
constexpr KnownUnit kUnits[] = {{9001, 1, "metres"},
                                {9002, 0.3048, "feet"},
                                {9003, 1200.0 / 3937.0, "US survey feet"},
                                {9005, 0.3047972654, "Clarke's feet"},
                                {9025, 0.001, "millimetres"},
                                {1025, 0.001, "millimetres"},
                                {1033, 0.01, "centimetres"},
                                {9036, 1000, "kilometres"},
                                {9096, 0.9144, "yards"}};

const KnownUnit* unit_named(double code) {
  for (const KnownUnit& unit : kUnits) {
    if (unit.code == code) return &unit;
  }
  return nullptr;
}

double at(std::span<const std::byte> bytes, std::size_t offset, ScalarType type) {
  return offset + scalar_bytes(type) <= bytes.size() ? read_scalar(type, bytes.data() + offset) : 0;
}

void read_geo_keys(std::span<const std::byte> keys, std::span<const std::byte> doubles, LasUnit* unit) {
  for (std::size_t offset = 8; offset + 8 <= keys.size(); offset += 8) {
    const auto field = [&](std::size_t i) { return at(keys, offset + 2 * i, ScalarType::kUint16); };
    const double key = field(0), value = field(3);
    if (key == kModelType && value == kGeographicModel) unit->is_geographic = true;
    if (key == kLinearUnitSize && field(1) == kGeoDoubles && unit->horizontal_m == 0) {
      unit->horizontal_m = at(doubles, 8 * static_cast<std::size_t>(value), ScalarType::kFloat64);
      unit->source = std::to_string(unit->horizontal_m) + " m a unit (GeoKey 3077)";
    }
    const KnownUnit* known = unit_named(value);
    if (known == nullptr) continue;
    if (key == kLinearUnits) unit->horizontal_m = known->metres, unit->source = std::string(known->name) + " (GeoKey 3076)";
    if (key == kVerticalUnits) unit->vertical_m = known->metres;
  }
}

/// What a UNIT or LENGTHUNIT of a WKT belongs to: the keywords around it, outermost first.
struct WktUnit {
  std::vector<std::string> around;
  std::string name;
  double metres = 0;
};

/// All length units of a text like PROJCS["name",GEOGCS[...],UNIT["metre",1]]; both kinds of brackets, names in quotes.
std::vector<WktUnit> wkt_units(std::string_view text) {
  std::vector<WktUnit> units;
  std::vector<std::string> around;
  std::string word;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const std::size_t end = text.find('"', i + 1);
      if (end == std::string_view::npos) break;
      if (!around.empty() && (around.back() == "UNIT" || around.back() == "LENGTHUNIT") && end + 1 < text.size() && text[end + 1] == ',') {
        const std::size_t number_end = text.find_first_of(",])", end + 2);
        const auto value = parse_double(trimmed(text.substr(end + 2, number_end == std::string_view::npos ? 0 : number_end - end - 2)));
        if (value) units.push_back({around, std::string(text.substr(i + 1, end - i - 1)), *value});
      }
      i = end;
    } else if (c == '[' || c == '(') {
      around.push_back(word);
      word.clear();
    } else if (c == ']' || c == ')') {
      if (!around.empty()) around.pop_back();
      word.clear();
    } else if (c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    } else {
      word.clear();
    }
  }
  return units;
}

/// The coordinate system that the unit is one of, also through an AXIS; "" where it belongs to an ellipsoid or a parameter.
std::string owner_of(const WktUnit& unit) {
  std::size_t last = unit.around.size() - 1;  // the unit itself
  if (last > 0 && unit.around[last - 1] == "AXIS") --last;
  return last > 0 ? unit.around[last - 1] : "";
}

void read_wkt(std::string_view text, LasUnit* unit) {
  for (const WktUnit& found : wkt_units(text)) {
    if (!(found.metres > 0 && found.metres < 1e4)) continue;
    const std::string owner = owner_of(found);
    if (owner == "PROJCS" || owner == "PROJCRS" || owner == "PROJECTEDCRS" || owner == "LOCAL_CS" || owner == "ENGCRS") {
      unit->horizontal_m = found.metres, unit->source = found.name + " (WKT)";
    }
    if (owner == "VERT_CS" || owner == "VERTCRS" || owner == "VERTICALCRS") unit->vertical_m = found.metres;
  }
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  const bool has_plane = has("PROJCS") || has("PROJCRS") || has("PROJECTEDCRS") || has("GEOCCS") || has("LOCAL_CS") || has("ENGCRS");
  const bool has_degrees = has("GEOGCS") || has("GEOGCRS") || has("GEOGRAPHICCRS");
  unit->is_geographic = has_degrees && !has_plane;
}

}  // namespace

LasUnit las_unit(std::span<const std::byte> records, std::uint32_t num_records) {
  std::span<const std::byte> keys, doubles;
  std::string_view wkt;
  for (std::uint32_t i = 0; i < num_records && records.size() >= kRecordHead; ++i) {
    const auto id = static_cast<std::uint16_t>(at(records, 18, ScalarType::kUint16));
    const auto length = static_cast<std::size_t>(at(records, 20, ScalarType::kUint16));
    const std::string_view user(reinterpret_cast<const char*>(records.data()) + 2, 16);
    if (length > records.size() - kRecordHead) break;
    const auto body = records.subspan(kRecordHead, length);
    if (user.starts_with("LASF_Projection")) {
      if (id == kGeoKeys) keys = body;
      if (id == kGeoDoubles) doubles = body;
      if (id == kWkt) wkt = {reinterpret_cast<const char*>(body.data()), body.size()};
    }
    records = records.subspan(kRecordHead + length);
  }
  LasUnit unit;
  read_geo_keys(keys, doubles, &unit);
  if (!wkt.empty()) read_wkt(wkt, &unit);
  if (!(unit.horizontal_m > 0 && std::isfinite(unit.horizontal_m))) unit.horizontal_m = 0;
  return unit;
}

}  // namespace camloc::mapping
