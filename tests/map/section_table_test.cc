// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Content that makes no sense although every hash is right.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "core/map/map_sections.h"
#include "tests/map/damaged_map.h"

namespace camloc {
namespace {

using map_format::SectionId;
using testing::expect_refused;
using testing::small_map;
using testing::TemporaryFolder;

TEST(SectionTable, HasTheCoreSectionsFirstAndNoneTwice) {
  const auto known = known_sections();
  ASSERT_GE(known.size(), map_format::kNumCoreSections);
  ASSERT_LE(known.size(), map_format::kMaxSections);
  for (std::uint32_t i = 0; i < known.size(); ++i) {
    if (i < map_format::kNumCoreSections) { EXPECT_EQ(known[i].id, SectionId{i}); }
    EXPECT_GT(known[i].element_bytes, 0U);
    for (std::uint32_t other = 0; other < i; ++other) {
      EXPECT_NE(known[i].id, known[other].id);
      EXPECT_STRNE(known[i].name, known[other].name);
    }
  }
}

template <typename T>
void poke(std::vector<std::byte>* bytes, SectionId id, std::size_t offset, T value) {
  std::memcpy(bytes->data() + testing::section_record(*bytes, id).offset + offset, &value, sizeof value);
}

// Damage with all hashes right: a bug of a writer, or malice. Offsets are those of map_format.h.
TEST(SectionTable, RefusesImpossibleContentWithRightHashes) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    const char* reason;
    std::function<void(std::vector<std::byte>*)> spoil;
  };
  const Case cases[] = {
      {"name without end", [](auto* b) { poke(b, SectionId::kMeta, 63, 'x'); }},
      {"lens", [](auto* b) { poke(b, SectionId::kMeta, 136, 3U); }},
      {"bad camera", [](auto* b) { poke(b, SectionId::kMeta, 144, -525.0); }},
      {"T_color_depth", [](auto* b) { poke(b, SectionId::kMeta, 304, 7.0); }},
      {"flag", [](auto* b) { poke(b, SectionId::kMeta, 400, 2U); }},
      {"pose sigma", [](auto* b) { poke(b, SectionId::kMeta, 408, -1.0); }},
      {"pyramid", [](auto* b) { poke(b, SectionId::kMeta, 424, kNan); }},
      {"pyramid", [](auto* b) { poke(b, SectionId::kMeta, 428, 1000U); }},
      {"cube", [](auto* b) { poke(b, SectionId::kCubes, 0, kNan); }},
      {"cube", [](auto* b) { poke(b, SectionId::kCubes, 12, 0.0F); }},
      {"cubes", [](auto* b) { poke(b, SectionId::kCubes, 16, 1U); }},
      {"cubes", [](auto* b) { poke(b, SectionId::kCubes, 20, 0xFFFFFFFFU); }},
      {"without descriptor", [](auto* b) { poke(b, SectionId::kLandmarks, 13, std::uint8_t{0}); }},
      {"do not add up", [](auto* b) { poke(b, SectionId::kLandmarks, 13, std::uint8_t{9}); }},
      {"without pose", [](auto* b) { poke(b, SectionId::kKeyframes, 0, 3.0F); }},
      {"without pose", [](auto* b) { poke(b, SectionId::kKeyframes, 16, kNan); }},
      {"keyframe list", [](auto* b) { poke(b, SectionId::kKeyframes, 28, 0x7FFFFFFFU); }},
      {"keyframe list", [](auto* b) { poke(b, SectionId::kKeyframes, 32, 0xFFFFFFFFU); }},
      {"does not exist", [](auto* b) { poke(b, SectionId::kKeyframeLists, 0, std::uint8_t{127}); }},
      {"not ascending", [](auto* b) { poke(b, SectionId::kKeyframeLists, 1, std::uint8_t{0}); }},
      {"inverted file", [](auto* b) { poke(b, SectionId::kWordBegin, 0, 1U); }},
      {"inverted file", [](auto* b) { poke(b, SectionId::kWordBegin, 4, 0xFFFFFFFFU); }},
      {"inverted file", [](auto* b) { poke(b, SectionId::kInvertedKeyframes, 0, std::uint16_t{3}); }},
      {"inverted file", [](auto* b) { poke(b, SectionId::kInvertedWeights, 0, std::uint8_t{0}); }},
      {"pose sigma", [](auto* b) { poke(b, SectionId::kMeta, 408, 1e200); }},
      {"pose sigma", [](auto* b) { poke(b, SectionId::kMeta, 408, 1001.0); }},
      {"pose sigma", [](auto* b) { poke(b, SectionId::kMeta, 416, 3.2); }},
      {"bad camera", [](auto* b) { poke(b, SectionId::kMeta, 336, 2e3); }},
      {"cube", [](auto* b) { poke(b, SectionId::kCubes, 4, -2e6F); }},
      {"cube", [](auto* b) { poke(b, SectionId::kCubes, 12, 2e6F); }},
      {"without pose", [](auto* b) { poke(b, SectionId::kKeyframes, 20, 2e6F); }},
      {"impossible place", [](auto* b) { poke(b, SectionId::kWcs, 32, 2e8); }},
      {"impossible covariance", [](auto* b) { poke(b, SectionId::kWcs, 56, -1e-9); }},
      {"impossible covariance", [](auto* b) { poke(b, SectionId::kWcs, 56 + 8 * 35, 10.0); }},
      {"impossible covariance",  // symmetric, with a correlation of 2
       [](auto* b) {
         for (int i = 0; i < 36; ++i)
           poke(b, SectionId::kWcs, 56 + 8 * static_cast<std::size_t>(i), i % 7 == 0 ? 1.0 : i == 1 || i == 6 ? 2.0 : 0.0);
       }},
      {"wcs", [](auto* b) { poke(b, SectionId::kWcs, 0, 2.0); }},
      {"wcs", [](auto* b) { poke(b, SectionId::kWcs, 56, std::numeric_limits<double>::infinity()); }},
  };
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  for (const Case& c : cases) {
    auto bytes = small_map();
    c.spoil(&bytes);
    testing::reseal(bytes);
    testing::write_bytes(path, bytes);
    expect_refused(path, ErrorCode::kCorrupt, c.reason);
  }
  auto untouched = small_map();
  testing::reseal(untouched);
  EXPECT_EQ(untouched, small_map());
}

}  // namespace
}  // namespace camloc
