// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Adding a section to the map, as a feature would: one file with its record, id, check, and how it is made and read, and
// one line in the table of sections. Readers that do not know it go on without it, or refuse the map where it says so.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/map/map_unpack.h"
#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc {

// ---- what core/map/keyframe_light.{h,cc} would hold: how bright the view of each keyframe was

struct LightRecord {
  std::uint16_t mean, spread;
};
constexpr map_format::SectionId kLightId = map_format::section_id("LITE");

static void pack_light(const std::vector<LightRecord>& light, MapData* map) {
  const auto bytes = std::as_bytes(std::span(light));
  map->extra_sections[kLightId] = {true, sizeof(LightRecord), {bytes.begin(), bytes.end()}};
}

static Status check_light(const MapSections& map) {
  if (map.section(kLightId).size() != map.keyframes.size() * sizeof(LightRecord)) {
    return {ErrorCode::kCorrupt, "light and keyframes do not belong together"};
  }
  return Status::ok();
}

static std::span<const LightRecord> light_of(const MapView& map) {
  const std::span<const std::byte> bytes = map.section(kLightId);
  return {reinterpret_cast<const LightRecord*>(bytes.data()), bytes.size() / sizeof(LightRecord)};
}

// ---- the table of section_table.cc, with one more line

static std::vector<SectionKind> newer_table() {
  std::vector<SectionKind> table(known_sections().begin(), known_sections().end());
  table.push_back({kLightId, "light", sizeof(LightRecord), check_light});
  return table;
}

namespace {

using testing::TemporaryFolder;

MapData map_with_light(bool is_optional = true) {
  MapData map = testing::make_synthetic_map({.num_landmarks = 20, .num_keyframes = 3, .num_words = 3});
  pack_light({{100, 5}, {110, 6}, {120, 7}}, &map);
  map.extra_sections[kLightId].is_optional = is_optional;
  return map;
}

/// 64-byte aligned, as read_map_sections() wants it.
struct AlignedBytes {
  explicit AlignedBytes(const std::vector<std::byte>& content) : storage(content.size() / 64 + 1), size(content.size()) {
    std::memcpy(storage.data(), content.data(), size);
  }
  [[nodiscard]] std::span<const std::byte> span() const { return {storage.data()->data(), size}; }
  struct alignas(64) Block : std::array<std::byte, 64> {};
  std::vector<Block> storage;
  std::size_t size;
};

Status open_status(const std::vector<std::byte>& bytes) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("map.cmap"), bytes);
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  return view.is_ok() ? Status::ok() : view.status();
}

/// What a reader with the longer table says.
Status newer_status(const std::vector<std::byte>& bytes) {
  const AlignedBytes aligned(bytes);
  const std::vector<SectionKind> table = newer_table();
  const Result<MapSections> map = read_map_sections(aligned.span(), table);
  return map.is_ok() ? check_map_content(*map) : map.status();
}

TEST(SectionSeam, IsWrittenAndReadBack) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_map(map_with_light(), folder.file("map.cmap")).is_ok());
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  ASSERT_TRUE(view.is_ok()) << view.status().message();
  const auto light = light_of(*view);
  ASSERT_EQ(light.size(), 3U);
  EXPECT_EQ(light[0].mean, 100);
  EXPECT_EQ(light[2].spread, 7);
  EXPECT_TRUE(view->section(map_format::section_id("NONE")).empty());
}

TEST(SectionSeam, AReaderThatDoesNotKnowItSkipsIt) {
  const std::vector<std::byte> bytes = *serialize_map(map_with_light());
  const AlignedBytes aligned(bytes);
  const Result<MapSections> older = read_map_sections(aligned.span());
  ASSERT_TRUE(older.is_ok()) << older.status().message();
  ASSERT_EQ(older->sections.size(), map_format::kNumCoreSections + 1);
  EXPECT_EQ(older->sections.back().kind, nullptr);
  EXPECT_EQ(older->sections.back().name, "LITE");

  // And finds everything else as it would be without.
  MapData without = map_with_light();
  without.extra_sections.clear();
  const AlignedBytes plain(*serialize_map(without));
  const MapSections expected = *read_map_sections(plain.span());
  for (std::uint32_t i = 0; i < map_format::kNumCoreSections; ++i) {
    EXPECT_TRUE(std::ranges::equal(older->sections[i].bytes, expected.sections[i].bytes)) << expected.sections[i].name;
  }
}

TEST(SectionSeam, AReaderOfTheLongerTableReadsMapsWithAndWithout) {
  MapData map = map_with_light();
  EXPECT_TRUE(newer_status(*serialize_map(map)).is_ok());
  map.extra_sections.clear();
  EXPECT_TRUE(newer_status(*serialize_map(map)).is_ok());
}

TEST(SectionSeam, ARequiredOneIsRefusedByWhoDoesNotKnowIt) {
  const std::vector<std::byte> bytes = *serialize_map(map_with_light(false));
  EXPECT_TRUE(newer_status(bytes).is_ok());
  const Status status = open_status(bytes);
  EXPECT_EQ(status.code(), ErrorCode::kUnsupported);
  EXPECT_NE(status.message().find("section LITE must be understood"), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("update camloc"), std::string::npos) << status.message();
}

TEST(SectionSeam, ItsContentIsCheckedByWhoKnowsIt) {
  MapData map = map_with_light();
  pack_light({{100, 5}}, &map);
  EXPECT_NE(newer_status(*serialize_map(map)).message().find("light and keyframes"), std::string::npos);
  map = map_with_light();
  map.extra_sections[kLightId].element_bytes = 2;
  EXPECT_NE(newer_status(*serialize_map(map)).message().find("size of the elements of section light"), std::string::npos);
}

TEST(SectionSeam, SurvivesAToolThatDoesNotKnowIt) {
  for (const bool is_optional : {true, false}) {
    MapData map = map_with_light(is_optional);
    if (!is_optional) map.extra_sections.clear();  // a tool that does not know a required one does not open the map
    map.extra_sections[map_format::section_id("ABCD")] = {true, 3, std::vector<std::byte>(300, std::byte{9})};
    map.extra_sections[map_format::section_id("NONE")] = {};
    const TemporaryFolder folder;
    ASSERT_TRUE(write_map(map, folder.file("map.cmap")).is_ok());
    const MapView view = MapView::open(folder.file("map.cmap")).value();
    MapData again = unpack_map(view);
    EXPECT_EQ(again.extra_sections.size(), map.extra_sections.size());
    EXPECT_EQ(*serialize_map(again, write_options_of(view)), testing::read_bytes(folder.file("map.cmap")));
    again.wcs.reset();
    ASSERT_TRUE(write_map(again, folder.file("map.cmap")).is_ok());
    const MapView changed = MapView::open(folder.file("map.cmap")).value();
    EXPECT_EQ(light_of(changed).size(), is_optional ? 3U : 0U);
    EXPECT_EQ(changed.section(map_format::section_id("ABCD")).size(), 300U);
  }
}

TEST(SectionSeam, EveryByteOfItIsCoveredAndMustBeThere) {
  const std::vector<std::byte> bytes = *serialize_map(map_with_light());
  const std::size_t entry = sizeof(map_format::FileHeader) + map_format::kNumCoreSections * sizeof(map_format::SectionRecord);
  for (std::size_t i = entry; i < bytes.size(); i = i == entry + 31 ? bytes.size() - 64 : i + 1) {
    std::vector<std::byte> flipped = bytes;
    flipped[i] ^= std::byte{0x10};
    ASSERT_EQ(open_status(flipped).code(), ErrorCode::kCorrupt) << i;
  }
  for (std::size_t length = bytes.size() - 64; length < bytes.size(); ++length) {
    ASSERT_EQ(open_status({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}).code(), ErrorCode::kCorrupt) << length;
  }
}

// With all hashes right: what a malicious writer would do.
TEST(SectionSeam, EntriesThatWrapOverlapOrRepeatAreRefused) {
  constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
  const std::function<void(map_format::SectionRecord*)> changes[] = {
      [](auto* r) { r->num_elements = kHuge; },
      [](auto* r) { r->num_elements = kHuge / 4 + 1; },
      [](auto* r) { r->num_elements += 64; },
      [](auto* r) { r->offset = kHuge - 63; },
      [](auto* r) { r->offset += 64; },
      [](auto* r) { r->offset -= 64; },
      [](auto* r) { r->element_bytes = 0; },
      [](auto* r) { r->element_bytes = 65535; },
      [](auto* r) { r->id = map_format::SectionId::kWcs; },
      [](auto* r) { r->id = map_format::SectionId::kMeta; },
      [](auto* r) { r->flags = 3; },
  };
  const std::size_t entry = sizeof(map_format::FileHeader) + map_format::kNumCoreSections * sizeof(map_format::SectionRecord);
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    std::vector<std::byte> bytes = *serialize_map(map_with_light());
    map_format::SectionRecord record;
    std::memcpy(&record, bytes.data() + entry, sizeof record);
    changes[i](&record);
    std::memcpy(bytes.data() + entry, &record, sizeof record);
    testing::reseal(bytes);
    EXPECT_EQ(open_status(bytes).code(), record.flags == 3 ? ErrorCode::kUnsupported : ErrorCode::kCorrupt) << i;
  }
}

TEST(SectionSeam, IdsAscend) {
  MapData map = map_with_light();
  map.extra_sections[map_format::section_id("ZZZZ")] = {};
  const std::vector<std::byte> good = *serialize_map(map);
  ASSERT_TRUE(open_status(good).is_ok());
  const std::size_t entry = sizeof(map_format::FileHeader) + map_format::kNumCoreSections * sizeof(map_format::SectionRecord);
  for (const map_format::SectionId id : {map_format::section_id("ZZZZ"), map_format::section_id("zzzz")}) {  // twice, and before
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + entry, &id, sizeof id);
    testing::reseal(bytes);
    EXPECT_NE(open_status(bytes).message().find("wrong table entry of section ZZZZ"), std::string::npos) << open_status(bytes).message();
  }
}

TEST(SectionSeam, TheirNumberIsBounded) {
  MapData map = map_with_light();
  for (std::uint32_t i = 0; map.extra_sections.size() < map_format::kMaxSections - map_format::kNumCoreSections; ++i) {
    map.extra_sections[map_format::SectionId{1000 + i}] = {};
  }
  std::vector<std::byte> bytes = *serialize_map(map);
  EXPECT_TRUE(open_status(bytes).is_ok());
  map_format::FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  for (const std::uint32_t num_sections : {0U, 10U, map_format::kMaxSections + 1, 0xFFFFFFFFU}) {
    header.num_sections = num_sections;
    header.header_hash = map_hash(std::as_bytes(std::span(&header, 1)).first(offsetof(map_format::FileHeader, header_hash)));
    std::memcpy(bytes.data(), &header, sizeof header);
    EXPECT_EQ(open_status(bytes).code(), ErrorCode::kCorrupt) << num_sections;
  }
}

}  // namespace
}  // namespace camloc
