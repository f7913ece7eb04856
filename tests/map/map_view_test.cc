// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map that is not exactly what the writer made is refused with a reason; a map that changes under an open view never
// leads a reader out of bounds. (What a good map holds is tested with the writer.)
#include "core/map/map_view.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <limits>

#include "core/base/checked.h"
#include "core/base/unique_fd.h"
#include "core/map/map_writer.h"
#include "core/map/retrieval.h"
#include "tests/map/synthetic_map.h"

namespace camloc {
namespace {

using map_format::FileHeader;
using map_format::SectionId;
using map_format::SectionRecord;
using testing::make_synthetic_map;
using testing::TemporaryFolder;

std::vector<std::byte> small_map(const testing::SyntheticMapOptions& options = {}) {
  const auto bytes = serialize_map(make_synthetic_map(options));
  EXPECT_TRUE(bytes.is_ok()) << bytes.status().message();
  return *bytes;
}

Status open_status(const std::string& path) {
  const Result<MapView> view = MapView::open(path);
  return view.is_ok() ? Status::ok() : view.status();
}

void expect_refused(const std::string& path, ErrorCode code, const std::string& reason) {
  const Status status = open_status(path);
  EXPECT_EQ(status.code(), code) << status.message();
  EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
  EXPECT_NE(status.message().find(reason), std::string::npos) << status.message() << " does not say: " << reason;
  EXPECT_EQ(status.message().find('\n'), std::string::npos) << status.message();
  EXPECT_NE(status.message().find(';'), std::string::npos) << status.message() << " gives no advice";
}

TEST(MapViewOpen, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  expect_refused(folder.file("missing.cmap"), ErrorCode::kNotFound, "No such file");
  expect_refused(folder.path().string(), ErrorCode::kIo, "folder");
  testing::write_bytes(folder.file("empty.cmap"), {});
  expect_refused(folder.file("empty.cmap"), ErrorCode::kCorrupt, "empty");
  ASSERT_EQ(::mkfifo(folder.file("pipe.cmap").c_str(), 0600), 0);
  expect_refused(folder.file("pipe.cmap"), ErrorCode::kIo, "no regular file");
  const std::vector<std::byte> text(5000, std::byte{'x'});
  testing::write_bytes(folder.file("text.cmap"), text);
  expect_refused(folder.file("text.cmap"), ErrorCode::kCorrupt, "does not begin like a camloc map");
  expect_refused(folder.file("text.cmap/below"), ErrorCode::kNotFound, "Not a directory");
}

// In a child, because root may read anything and cannot come back from another user.
TEST(MapViewOpenDeathTest, RefusesAnUnreadableFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, small_map());
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0200), 0);
  EXPECT_EXIT(
      {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(2);
        const Status status = open_status(path);
        ::_exit(status.code() == ErrorCode::kIo && status.message().find("ermission") != std::string::npos ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

TEST(MapViewOpen, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  const auto bytes = small_map();
  std::vector<std::size_t> lengths = {1, 7, 8, 63, 64, 65, 447, 448, bytes.size() - 1};
  for (std::uint32_t i = 0; i < map_format::kNumSections; ++i) {
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

TEST(MapViewOpen, RefusesBytesAtTheEnd) {
  const TemporaryFolder folder;
  auto bytes = small_map();
  bytes.resize(bytes.size() + 64);
  testing::write_bytes(folder.file("map.cmap"), bytes);
  expect_refused(folder.file("map.cmap"), ErrorCode::kCorrupt, "longer");
}

TEST(MapViewOpen, RefusesEveryFlippedByte) {
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

TEST(MapViewOpen, NamesOtherVersionsAndByteOrders) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, with_header(small_map(), [](FileHeader* h) { h->version = 2; }));
  expect_refused(path, ErrorCode::kUnsupported, "made by a newer camloc");
  testing::write_bytes(path, with_header(small_map(), [](FileHeader* h) { h->version = 0; }));
  expect_refused(path, ErrorCode::kUnsupported, "no longer read");

  auto swapped = small_map();  // a big-endian machine writes every number of the header the other way round
  std::reverse(swapped.begin() + 8, swapped.begin() + 12);
  std::reverse(swapped.begin() + 12, swapped.begin() + 16);
  testing::write_bytes(path, swapped);
  expect_refused(path, ErrorCode::kUnsupported, "byte order");
}

template <typename T>
void poke(std::vector<std::byte>* bytes, SectionId id, std::size_t offset, T value) {
  std::memcpy(bytes->data() + testing::section_record(*bytes, id).offset + offset, &value, sizeof value);
}

// Damage with all hashes right: a bug of a writer, or malice. Offsets are those of map_format.h.
TEST(MapViewOpen, RefusesImpossibleContentWithRightHashes) {
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

TEST(MapViewOpen, RefusesSectionTablesThatWrapOrOverlap) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();
  for (std::uint32_t i = 0; i < map_format::kNumSections; ++i) {
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
        [](SectionRecord* r) { r->element_bytes *= 2; },
        [](SectionRecord* r) { r->id = static_cast<SectionId>(99); },
    };
    for (const auto& change : changes) {
      auto bytes = small_map();
      SectionRecord record = testing::section_record(bytes, id);
      change(&record);
      std::memcpy(bytes.data() + sizeof(FileHeader) + i * sizeof record, &record, sizeof record);
      testing::reseal(bytes);
      testing::write_bytes(path, bytes);
      ASSERT_EQ(open_status(path).code(), ErrorCode::kCorrupt) << map_format::kSectionNames[i];
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

/// Calls everything and touches every byte that a reader may touch.
std::uint64_t use_everything(const MapView& view) {
  const MapInfo& info = view.info();
  std::uint64_t sum = view.is_damaged() ? 1 : 0;
  for (const auto& d : view.descriptors()) sum += d.bits[0] ^ d.bits[3];
  for (std::uint32_t i = 0; i < info.num_landmarks; ++i) {
    const std::uint32_t cube = view.cube_of(i);
    EXPECT_LT(cube, info.num_cubes);
    EXPECT_LE(view.first_descriptor(i) + view.num_descriptors(i), info.num_descriptors);
    for (const auto& d : view.landmark_descriptors(i)) sum += d.bits[1];
    const auto& record = view.landmarks()[i];
    EXPECT_NEAR(MapView::direction(record).norm(), 1, 1e-4);
    EXPECT_GT(MapView::reference_m(record.min_reference) + MapView::angle_rad(record) + MapView::view_cosine(record), -1.0F);
    EXPECT_LE((view.position_m(i) - Eigen::Vector3f(view.cubes()[cube].origin_m.data())).maxCoeff(), 4.001F);
  }
  std::vector<std::uint32_t> list(info.max_keyframe_landmarks);
  for (std::uint32_t k = 0; k < info.num_keyframes; ++k) {
    EXPECT_TRUE(view.keyframe_pose(k).translation.allFinite());
    const std::size_t count = view.keyframe_landmarks(k, list);
    EXPECT_EQ(count, view.keyframes()[k].num_landmark_entries);
    for (std::size_t i = 0; i < count; ++i) EXPECT_LT(list[i], info.num_landmarks);
  }
  for (std::uint32_t w = 0; w < info.num_words; ++w) {
    EXPECT_EQ(view.word_keyframes(w).size(), view.word_weights(w).size());
    for (std::size_t i = 0; i < view.word_keyframes(w).size(); ++i) sum += view.word_keyframes(w)[i] + view.word_weights(w)[i];
    EXPECT_TRUE(std::isfinite(view.word_idf(w)));
  }
  Retriever retriever(view, 100);
  for (const auto& r : retriever.retrieve(view.words(), 10)) EXPECT_LT(r.keyframe, info.num_keyframes);
  return sum;
}

TEST(MapView, OverwrittenWhileMappedStaysInBounds) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  testing::write_bytes(path, small_map({.num_landmarks = 300, .num_keyframes = 5, .landmarks_per_keyframe = 60}));
  const Result<MapView> view = MapView::open(path);
  ASSERT_TRUE(view.is_ok()) << view.status().message();
  const std::uint64_t before = use_everything(*view);
  const UniqueFd fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  std::mt19937 random(9);
  for (const int fill : {-1, -1, -1, 0xFF, 0x00, 0x80}) {
    std::vector<std::uint8_t> noise(view->info().file_bytes);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(fill < 0 ? random() : static_cast<unsigned>(fill));
    ASSERT_EQ(::pwrite(fd.get(), noise.data(), noise.size(), 0), static_cast<ssize_t>(noise.size()));
    EXPECT_NE(use_everything(*view), before);  // the noise does show
  }
}

TEST(MapView, UnpacksNoMoreThanTheBufferHolds) {
  const TemporaryFolder folder;
  testing::write_bytes(folder.file("map.cmap"), small_map());
  const Result<MapView> view = MapView::open(folder.file("map.cmap"));
  ASSERT_TRUE(view.is_ok());
  std::vector<std::uint32_t> all(15), some(6, 77);
  ASSERT_EQ(view->keyframe_landmarks(1, all), 15U);
  ASSERT_EQ(view->keyframe_landmarks(1, std::span(some).first(5)), 5U);
  EXPECT_TRUE(std::equal(some.begin(), some.begin() + 5, all.begin()));
  EXPECT_EQ(some[5], 77U);
  EXPECT_EQ(view->keyframe_landmarks(1, {}), 0U);
}

TEST(MapView, KnowsWhenTheFileOnDiskIsAnother) {
  const TemporaryFolder folder;
  const std::string path = folder.file("map.cmap");
  ASSERT_TRUE(write_map(make_synthetic_map(), path).is_ok());
  const auto open = [&] { return MapView::open(path).value(); };
  {
    const MapView view = open();
    EXPECT_FALSE(view.is_stale());
    ASSERT_TRUE(write_map(make_synthetic_map(), path).is_ok());  // replaced, by the same bytes even
    EXPECT_TRUE(view.is_stale());
    EXPECT_GT(use_everything(view), 0U);  // the old file lives on
  }
  {
    const MapView view = open();
    std::filesystem::last_write_time(path, std::filesystem::last_write_time(path) + std::chrono::seconds(1));
    EXPECT_TRUE(view.is_stale());
  }
  {
    const MapView view = open();
    EXPECT_FALSE(view.is_stale());
    std::filesystem::resize_file(path, 100);
    EXPECT_TRUE(view.is_stale());
  }
  ASSERT_TRUE(write_map(make_synthetic_map(), path).is_ok());
  const MapView view = open();
  std::filesystem::remove(path);
  EXPECT_TRUE(view.is_stale());
}

TEST(MapView, Moves) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_map(make_synthetic_map({.seed = 1}), folder.file("a.cmap")).is_ok());
  ASSERT_TRUE(write_map(make_synthetic_map({.num_landmarks = 50, .seed = 2}), folder.file("b.cmap")).is_ok());
  MapView a = MapView::open(folder.file("a.cmap")).value();
  MapView b = MapView::open(folder.file("b.cmap")).value();
  a = std::move(b);
  EXPECT_EQ(a.info().num_landmarks, 50U);
  EXPECT_GT(use_everything(a), 0U);
}

}  // namespace
}  // namespace camloc
