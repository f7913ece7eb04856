// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The codes of landmark_codes.h, and the layout that map_format.h documents, walked through by hand.
#include "core/map/map_format.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "core/map/landmark_codes.h"
#include "core/map/map_unpack.h"
#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using namespace map_format;
using testing::Random;

TEST(LandmarkCodes, DirectionStaysWithinADegree) {
  Random random(3);
  double worst_rad = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3f direction = random.direction().cast<float>();
    const Eigen::Vector3f decoded = decode_direction(encode_direction(direction));
    ASSERT_NEAR(decoded.norm(), 1, 1e-5);
    worst_rad = std::max(worst_rad, 2.0 * std::asin(std::min(1.0, 0.5 * static_cast<double>((decoded - direction).norm()))));
  }
  EXPECT_LT(worst_rad, 1.0 * std::numbers::pi / 180);
  EXPECT_GT(worst_rad, 0.1 * std::numbers::pi / 180);  // it is quantized at all
}

TEST(LandmarkCodes, DirectionOfTheAxesIsExact) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      const Eigen::Vector3f direction = sign * Eigen::Vector3f::Unit(axis);
      EXPECT_LT((decode_direction(encode_direction(direction)) - direction).norm(), 1e-6F) << axis << " " << sign;
    }
  }
}

TEST(LandmarkCodes, EveryDirectionCodeIsAUnitVector) {
  for (int a = 0; a < 256; ++a) {
    for (int b = 0; b < 256; ++b) {
      const auto decoded = decode_direction({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
      ASSERT_NEAR(decoded.norm(), 1, 1e-5) << a << " " << b;
    }
  }
}

TEST(LandmarkCodes, ReferenceTableIsTheDocumentedFormula) {
  for (int code = 0; code < 256; ++code) {
    const double expected = kMinReferenceM * std::exp2(code / kReferenceCodesPerOctave);
    EXPECT_NEAR(kReferenceTable[code] / expected, 1, 1e-6) << code;
  }
  EXPECT_GT(kReferenceTable[255], 100);
}

TEST(LandmarkCodes, ReferenceBoundsEncloseAndStayClose) {
  Random random(4);
  for (int i = 0; i < 10000; ++i) {
    const auto distance_m = static_cast<float>(0.1 * std::exp(random.uniform(0.001, 7.0)));
    const float below = kReferenceTable[encode_reference_down(distance_m)];
    const float above = kReferenceTable[encode_reference_up(distance_m)];
    ASSERT_LE(below, distance_m);
    ASSERT_GE(above, distance_m);
    ASSERT_LT(above / below, 1.0285F);
  }
  for (int code = 0; code < 256; ++code) {
    EXPECT_EQ(encode_reference_down(kReferenceTable[code]), code);
    EXPECT_EQ(encode_reference_up(kReferenceTable[code]), code);
  }
  EXPECT_EQ(encode_reference_down(0), 0);
  EXPECT_EQ(encode_reference_up(1e9F), 255);
}

TEST(LandmarkCodes, ViewCosineIsNeverLargerThanGiven) {
  for (int i = -1000; i <= 1000; ++i) {
    const float cosine = static_cast<float>(i) / 1000;
    const float decoded = static_cast<float>(encode_view_cosine(cosine)) / 127.5F - 1.0F;
    EXPECT_LE(decoded, cosine + 1e-6F);
    EXPECT_GT(decoded, cosine - 1.0F / 127);
  }
  EXPECT_EQ(encode_view_cosine(1), 255);
  EXPECT_EQ(encode_view_cosine(-2), 0);
}

TEST(LandmarkCodes, AngleWrapsAround) {
  constexpr double kTurn = 2 * std::numbers::pi;
  EXPECT_EQ(encode_angle(0), 0);
  EXPECT_EQ(encode_angle(static_cast<float>(kTurn)), 0);
  EXPECT_EQ(encode_angle(static_cast<float>(-kTurn / 4)), 192);
  EXPECT_EQ(encode_angle(static_cast<float>(kTurn * 255.7 / 256)), 0);
  EXPECT_EQ(encode_angle(static_cast<float>(kTurn * 3.5)), 128);
}

TEST(LandmarkCodes, VarintRoundTripsAndNeverReadsPastTheEnd) {
  const std::vector<std::uint32_t> numbers = {0, 1, 127, 128, 255, 300, 16383, 16384, 0x7FFFFFFF, 0xFFFFFFFF};
  std::vector<std::uint8_t> bytes;
  for (const auto number : numbers) append_varint(number, &bytes);
  std::size_t cursor = 0;
  for (const auto number : numbers) EXPECT_EQ(read_varint(bytes, &cursor), number);
  EXPECT_EQ(cursor, bytes.size());
  EXPECT_EQ(read_varint(bytes, &cursor), 0U);
  EXPECT_EQ(cursor, bytes.size());

  const std::vector<std::uint8_t> endless(20, 0xFF);
  cursor = 0;
  EXPECT_EQ(read_varint(endless, &cursor), 0xFFFFFFFFU);
  EXPECT_EQ(cursor, 5U);
  cursor = 18;
  EXPECT_EQ(read_varint(endless, &cursor), 0x3FFFU);
  EXPECT_EQ(cursor, 20U);
}

template <typename T>
T number_at(std::span<const std::byte> bytes, std::size_t offset) {
  T number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

TEST(MapFormat, FileIsLaidOutAsDocumented) {
  const auto bytes = serialize_map(testing::make_synthetic_map());
  ASSERT_TRUE(bytes.is_ok()) << bytes.status().message();
  EXPECT_EQ(std::memcmp(bytes->data(), "CMAP\r\n\x1a\n", 8), 0);
  EXPECT_EQ(number_at<std::uint32_t>(*bytes, 8), 0x01020304U);
  EXPECT_EQ(number_at<std::uint32_t>(*bytes, 12), 2U);
  EXPECT_EQ(number_at<std::uint64_t>(*bytes, 16), bytes->size());
  EXPECT_EQ(number_at<std::uint64_t>(*bytes, 24), XXH3_64bits(bytes->data() + 64, 448 - 64));
  EXPECT_EQ(number_at<std::uint32_t>(*bytes, 32), 11U);
  EXPECT_EQ(number_at<std::uint64_t>(*bytes, 56), XXH3_64bits(bytes->data(), 56));

  constexpr std::uint32_t kElementBytes[] = {432, 24, 16, 32, 36, 1, 32, 4, 2, 1, 344};
  std::uint64_t offset = 448;
  for (std::uint32_t i = 0; i < 11; ++i) {
    const std::size_t entry = 64 + 32 * i;
    EXPECT_EQ(number_at<std::uint32_t>(*bytes, entry), i);
    EXPECT_EQ(number_at<std::uint16_t>(*bytes, entry + 4), kElementBytes[i]);
    EXPECT_EQ(number_at<std::uint16_t>(*bytes, entry + 6), 0U);
    EXPECT_EQ(number_at<std::uint64_t>(*bytes, entry + 8), offset);
    const auto num_elements = number_at<std::uint64_t>(*bytes, entry + 16);
    const std::uint64_t padded = (num_elements * kElementBytes[i] + 63) / 64 * 64;
    ASSERT_LE(offset + padded, bytes->size());
    EXPECT_EQ(number_at<std::uint64_t>(*bytes, entry + 24), XXH3_64bits(bytes->data() + offset, padded)) << known_sections()[i].name;
    offset += padded;
  }
  EXPECT_EQ(offset, bytes->size());
}

// A new value here means that the bytes of a map changed: then kVersion must change too, or old maps are misread.
TEST(MapFormat, BytesOfVersion2DoNotChange) {
  const auto bytes = serialize_map(testing::make_synthetic_map());
  ASSERT_TRUE(bytes.is_ok());
  ASSERT_EQ(kVersion, 2U);
  EXPECT_EQ(XXH3_64bits(bytes->data(), bytes->size()), 9233094745959697601U);
}

// data/format1.cmap was written by the last camloc of format 1, from these options.
testing::SyntheticMapOptions format1_options() {
  return {.num_landmarks = 6, .num_keyframes = 2, .landmarks_per_keyframe = 4, .num_words = 3};
}

std::string format1_path() { return (std::filesystem::path(__FILE__).parent_path() / "data/format1.cmap").string(); }

TEST(MapFormat, Format1IsReadAndWrittenAgainAsFormat2) {
  const Result<MapView> old_map = MapView::open(format1_path());
  ASSERT_TRUE(old_map.is_ok()) << old_map.status().message();
  EXPECT_EQ(old_map->info().version, 1U);
  EXPECT_EQ(old_map->sections().size(), kNumCoreSections);

  const auto rewritten = serialize_map(unpack_map(*old_map));
  ASSERT_TRUE(rewritten.is_ok()) << rewritten.status().message();
  EXPECT_EQ(*rewritten, *serialize_map(testing::make_synthetic_map(format1_options())));
  EXPECT_EQ(number_at<std::uint32_t>(*rewritten, 12), 2U);
  // The same map: only the version and the hash of the header are others.
  const std::vector<std::byte> old_bytes = testing::read_bytes(format1_path());
  EXPECT_EQ(number_at<std::uint64_t>(*rewritten, 24), old_map->info().map_id);
  ASSERT_EQ(rewritten->size(), old_bytes.size());
  EXPECT_TRUE(std::equal(old_bytes.begin() + 64, old_bytes.end(), rewritten->begin() + 64));
}

TEST(MapFormat, Format1HasNeitherFurtherSectionsNorFlags) {
  const testing::TemporaryFolder folder;
  const auto opened = [&](std::span<std::byte> bytes) {
    testing::reseal(bytes);
    testing::write_bytes(folder.file("map.cmap"), bytes);
    return MapView::open(folder.file("map.cmap")).status();
  };
  std::vector<std::byte> bytes = testing::read_bytes(format1_path());
  ASSERT_TRUE(opened(bytes).is_ok());
  bytes[64 + 32 * 10 + 6] = std::byte{1};
  EXPECT_NE(opened(bytes).message().find("section wcs has flags"), std::string::npos);

  MapData map = testing::make_synthetic_map(format1_options());
  map.extra_sections[section_id("TEST")].bytes.resize(8);
  bytes = *serialize_map(map);
  ASSERT_TRUE(opened(bytes).is_ok());
  bytes[12] = std::byte{1};
  EXPECT_NE(opened(bytes).message().find("wrong section table"), std::string::npos);
}

}  // namespace
}  // namespace camloc
