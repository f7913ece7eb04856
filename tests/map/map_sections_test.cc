// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A file that is not exactly what the writer made: cut, longer, a byte flipped, another version, a table that wraps.
#include "core/map/map_sections.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "core/base/checked.h"
#include "core/base/unique_fd.h"
#include "tests/map/damaged_map.h"

namespace camloc {
namespace {

using map_format::FileHeader;
using map_format::SectionId;
using map_format::SectionRecord;
using testing::expect_refused;
using testing::open_status;
using testing::small_map;
using testing::TemporaryFolder;

TEST(MapSections, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  const auto bytes = small_map();
  std::vector<std::size_t> lengths = {1, 7, 8, 63, 64, 65, 447, 448, bytes.size() - 1};
  for (std::uint32_t i = 0; i < map_format::kNumCoreSections; ++i) {
    const SectionRecord record = testing::section_record(bytes, static_cast<SectionId>(i));
    lengths.push_back(record.offset);
    lengths.push_back(record.offset + record.num_elements * record.element_bytes / 2);
  }
  testing::Random random(7);
  for (int i = 0; i < 300; ++i) lengths.push_back(1 + random.below(static_cast<std::uint32_t>(bytes.size() - 1)));
  for (const std::size_t length : lengths) {
    if (length == bytes.size()) continue;  // begin of an empty last section
    testing::write_bytes(path, std::span(bytes).first(length));
    const Status status = open_status(path);
    ASSERT_EQ(status.code(), ErrorCode::kCorrupt) << length << ": " << status.message();
    ASSERT_NE(status.message().find(length < 8 ? "too short" : "truncated"), std::string::npos) << status.message();
  }
}

TEST(MapSections, RefusesBytesAtTheEnd) {
  const TemporaryFolder folder;
  auto bytes = small_map();
  bytes.resize(bytes.size() + 64);
  testing::write_bytes(folder.file("map.cmap"), bytes);
  expect_refused(folder.file("map.cmap"), ErrorCode::kCorrupt, "longer");
}

TEST(MapSections, RefusesEveryFlippedByte) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  const auto bytes = small_map({.num_landmarks = 6, .num_keyframes = 2, .landmarks_per_keyframe = 4, .num_words = 3});
  testing::write_bytes(path, bytes);
  ASSERT_TRUE(open_status(path).is_ok());
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int mask : {0x01, 0x80, 0xFF}) {
      const std::byte flipped = bytes[i] ^ static_cast<std::byte>(mask);
      ASSERT_EQ(::pwrite(fd.get(), &flipped, 1, static_cast<off_t>(i)), 1);
      const Status status = open_status(path);
      ASSERT_EQ(status.code(), ErrorCode::kCorrupt) << "byte " << i << ": " << status.message();
    }
    ASSERT_EQ(::pwrite(fd.get(), &bytes[i], 1, static_cast<off_t>(i)), 1);
  }
  EXPECT_TRUE(open_status(path).is_ok());
}

/// Changes the header and makes its hash right again, as another version of camloc would write it.
std::vector<std::byte> with_header(std::vector<std::byte> bytes, const std::function<void(FileHeader*)>& change) {
  FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  change(&header);
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_hash = map_hash(std::span<const std::byte>(bytes).first(offsetof(FileHeader, header_hash)));
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

TEST(MapSections, NamesOtherVersionsAndByteOrders) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, with_header(small_map(), [](FileHeader* h) { h->version = map_format::kVersion + 1; }));
  expect_refused(path, ErrorCode::kUnsupported, "made by a newer camloc");
  testing::write_bytes(path, with_header(small_map(), [](FileHeader* h) { h->version = 0; }));
  expect_refused(path, ErrorCode::kUnsupported, "no longer read");

  auto swapped = small_map();  // a big-endian machine writes every number of the header the other way round
  std::reverse(swapped.begin() + 8, swapped.begin() + 12);
  std::reverse(swapped.begin() + 12, swapped.begin() + 16);
  testing::write_bytes(path, swapped);
  expect_refused(path, ErrorCode::kUnsupported, "byte order");
}

TEST(MapSections, RefusesSectionTablesThatWrapOrOverlap) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
  for (std::uint32_t i = 0; i < map_format::kNumCoreSections; ++i) {
    const auto id = static_cast<SectionId>(i);
    const std::function<void(SectionRecord*)> changes[] = {
        [](SectionRecord* r) { r->num_elements = kHuge; },
        [](SectionRecord* r) { r->num_elements = kHuge / r->element_bytes + 1; },
        [](SectionRecord* r) { r->num_elements = 0xFFFFFFFE; },
        [](SectionRecord* r) { r->num_elements += 64; },
        [](SectionRecord* r) { r->offset = kHuge - 63; },
        [](SectionRecord* r) { r->offset += 64; },
        [](SectionRecord* r) { r->offset = 0; },
        [](SectionRecord* r) { r->element_bytes = 0; },
        [](SectionRecord* r) { r->element_bytes = static_cast<std::uint16_t>(2 * r->element_bytes); },
        [](SectionRecord* r) { r->id = static_cast<SectionId>(99); },
    };
    for (const auto& change : changes) {
      auto bytes = small_map();
      SectionRecord record = testing::section_record(bytes, id);
      change(&record);
      std::memcpy(bytes.data() + sizeof(FileHeader) + i * sizeof record, &record, sizeof record);
      testing::reseal(bytes);
      testing::write_bytes(path, bytes);
      ASSERT_EQ(open_status(path).code(), ErrorCode::kCorrupt) << known_sections()[i].name;
    }
  }
}

TEST(Checked, SaysWhenItWouldWrap) {
  constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(checked_add(kMax - 1, 1), kMax);
  EXPECT_FALSE(checked_add(kMax, 1));
  EXPECT_EQ(checked_multiply(1ULL << 32, (1ULL << 32) - 1), kMax - 0xFFFFFFFFULL);
  EXPECT_FALSE(checked_multiply(1ULL << 32, 1ULL << 32));
  EXPECT_EQ(checked_align_up(65, 64), 128U);
  EXPECT_EQ(checked_align_up(64, 64), 64U);
  EXPECT_EQ(checked_align_up(0, 64), 0U);
  EXPECT_FALSE(checked_align_up(kMax, 64));
  EXPECT_EQ(checked_end(10, 3, 4), 22U);
  EXPECT_FALSE(checked_end(kMax - 10, 3, 4));
  EXPECT_FALSE(checked_end(0, kMax / 2, 3));
}

}  // namespace
}  // namespace camloc
