// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/sequence.h"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>
#include <tuple>

#include "tests/drivers/test_folder.h"
#include "tests/io/sequence_checks.h"

namespace camloc {
namespace {

TEST(Sequence, TumWithDepthByNearestStamp) {
  const TestFolder folder;
  touch(folder, {"rgb/1.jpg", "rgb/2.jpg", "rgb/3.jpg", "depth/1.png", "depth/2.png", "depth/3.png"});
  folder.write("rgb.txt", "# color\n10.000 rgb/1.jpg\n10.033 rgb/2.jpg\n10.066 rgb/3.jpg\n");
  folder.write("depth.txt", "9.999 depth/1.png\n10.012 depth/2.png\n10.030 depth/3.png\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_EQ(sequence->layout, "tum");
  ASSERT_EQ(sequence->frames.size(), 3U);
  EXPECT_EQ(sequence->frames[1].index, 1U);
  EXPECT_EQ(sequence->frames[1].stamp_ns, 10033000000);
  EXPECT_EQ(sequence->frames[0].color_path, folder / "rgb/1.jpg");
  EXPECT_EQ(sequence->frames[0].depth_path, folder / "depth/1.png");
  EXPECT_EQ(sequence->frames[1].depth_path, folder / "depth/3.png");
  EXPECT_EQ(sequence->frames[2].depth_path, "") << "36 ms off";
}

TEST(Sequence, DepthIsGivenOutOnce) {
  const TestFolder folder;
  touch(folder, {"a", "b", "d"});
  folder.write("rgb.txt", "1.000 a\n1.010 b\n");
  folder.write("depth.txt", "1.008 d\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok());
  EXPECT_EQ(sequence->frames[0].depth_path, "");
  EXPECT_EQ(sequence->frames[1].depth_path, folder / "d");
}

/// "SECONDS x" a line; `stamps_us` ascend.
std::string list_of(const std::vector<std::int64_t>& stamps_us, const std::string& prefix) {
  std::string text;
  for (const std::int64_t us : stamps_us) {
    const std::string fraction = std::to_string(1'000'000 + us % 1'000'000).substr(1);
    text += std::to_string(us / 1'000'000) + "." + fraction + " " + prefix + std::to_string(us % 10) + "\n";
  }
  return text;
}

/// The contract, tried on every pair: of all pairs left the closest, then the earlier colour, then the earlier depth.
std::vector<std::int64_t> closest_first(const std::vector<std::int64_t>& colors, const std::vector<std::int64_t>& depths) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> all;
  for (std::size_t c = 0; c < colors.size(); ++c) {
    for (std::size_t d = 0; d < depths.size(); ++d) {
      if (std::abs(colors[c] - depths[d]) <= 20'000) all.emplace_back(std::abs(colors[c] - depths[d]), c, d);
    }
  }
  std::sort(all.begin(), all.end());
  std::vector<std::int64_t> of_color(colors.size(), -1);
  std::set<std::size_t> taken;
  for (const auto& [gap, c, d] : all) {
    if (of_color[c] < 0 && taken.insert(d).second) of_color[c] = static_cast<std::int64_t>(d);
  }
  return of_color;
}

std::vector<std::int64_t> ascending_stamps(std::mt19937& random, std::size_t count, int largest_us) {
  std::set<std::int64_t> stamps;
  while (stamps.size() < count) stamps.insert(std::uniform_int_distribution<int>(0, largest_us)(random));
  return {stamps.begin(), stamps.end()};
}

TEST(Sequence, ClosestPairsFirstAsEveryPairTried) {
  const TestFolder folder;
  for (int i = 0; i < 60; ++i) touch(folder, {("d" + std::to_string(i)).c_str()});
  touch(folder, {"c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "c9"});
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    const int largest_us = round % 3 == 0 ? 99 : round % 3 == 1 ? 60'000 : 900'000;  // many ties, some, none
    const std::vector<std::int64_t> colors = ascending_stamps(random, 40, largest_us);
    const std::vector<std::int64_t> depths = ascending_stamps(random, 60, largest_us);
    folder.write("rgb.txt", list_of(colors, "c"));
    std::string text;
    for (std::size_t i = 0; i < depths.size(); ++i) text += list_of({depths[i]}, "").substr(0, 8) + " d" + std::to_string(i) + "\n";
    folder.write("depth.txt", text);
    const auto sequence = read_sequence(folder.path());
    ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
    const std::vector<std::int64_t> expected = closest_first(colors, depths);
    for (std::size_t c = 0; c < colors.size(); ++c) {
      const std::string depth = expected[c] < 0 ? "" : folder / ("d" + std::to_string(expected[c]));
      ASSERT_EQ(sequence->frames[c].depth_path, depth) << "round " << round << ", colour " << c;
    }
  }
}

// All pairs within 20 ms would be 400 million here: 10 GB and minutes.
TEST(Sequence, StampsCloseTogetherAreStillPairedInOneGo) {
  const TestFolder folder;
  touch(folder, {"x"});
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += "0." + std::to_string(10'000'000 + i) + " x\n";
  folder.write("rgb.txt", text);
  folder.write("depth.txt", text);
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  ASSERT_EQ(sequence->frames.size(), 20'000U);
  for (const SequenceFrame& frame : sequence->frames) ASSERT_FALSE(frame.depth_path.empty());
}

TEST(Sequence, TumAsOthersWriteIt) {
  const TestFolder folder;
  touch(folder, {"a b.png", "c.png"});
  folder.write("rgb.txt", "\xEF\xBB\xBF# windows\r\n1.0,a b.png\r\n\r\n2.0\tc.png  \r\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  ASSERT_EQ(sequence->frames.size(), 2U);
  EXPECT_EQ(sequence->frames[0].color_path, folder / "a b.png");
  EXPECT_EQ(sequence->frames[1].color_path, folder / "c.png");
  EXPECT_EQ(sequence->frames[1].depth_path, "") << "no depth.txt";
}

TEST(Sequence, BadListsNameFileAndLine) {
  const TestFolder folder;
  touch(folder, {"a", "b"});
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"# c\n2.0 a\n1.0 b\n", "rgb.txt:3: stamp '1.0' is before the one above"},
      {"1.0 a\n2.0 none.png\n", "none.png does not exist"},
      {"1.0 a\n\nxyz b\n", "rgb.txt:3: stamp 'xyz'"},
      {"1.0\n", "rgb.txt:1: expected"},
      {"1305031102,175304 a\n", "rgb.txt:1: image"},
      {"# nothing\n", "lists no image"},
  };
  for (const auto& one : cases) {
    folder.write("rgb.txt", one.text);
    expect_error(read_sequence(folder.path()), ErrorCode::kInvalid, one.part);
  }
  folder.write("rgb.txt", "1.0 a\n");
  folder.write("depth.txt", "1.0 none.png\n");
  expect_error(read_sequence(folder.path()), ErrorCode::kInvalid, "depth.txt:1: image");
}

TEST(Sequence, RepeatedStampsAreLeftOutCountedAndNamed) {
  const TestFolder folder;
  touch(folder, {"a", "b", "c"});
  folder.write("rgb.txt", "1.0 a\n1.0 b\nnan b\n2.0 c\n");
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  ASSERT_EQ(sequence->frames.size(), 2U);
  EXPECT_EQ(sequence->frames[0].color_path, folder / "a");
  EXPECT_EQ(sequence->frames[1].color_path, folder / "c");
  EXPECT_EQ(sequence->frames[1].index, 1U);
  ASSERT_EQ(sequence->notes.size(), 2U);
  EXPECT_NE(sequence->notes[0].find("rgb.txt: 1 image left out with the stamp of the one before, line 2"), std::string::npos)
      << sequence->notes[0];
  EXPECT_NE(sequence->notes[1].find("without a time, line 3"), std::string::npos) << sequence->notes[1];
}

TEST(Sequence, SaysHowFarColourAndDepthAreApart) {
  const TestFolder folder;
  touch(folder, {"a", "b", "c", "d"});
  folder.write("rgb.txt", "1.000 a\n1.100 b\n");
  folder.write("depth.txt", "1.025 c\n1.1254 d\n");
  const auto narrow = read_sequence(folder.path());
  ASSERT_TRUE(narrow.is_ok());
  EXPECT_EQ(narrow->frames[0].depth_path, "");
  ASSERT_EQ(narrow->notes.size(), 1U);
  EXPECT_NE(narrow->notes[0].find("2 colour and 2 depth images, none nearer than 25.0 ms; pairs may be 20.0 ms apart"), std::string::npos)
      << narrow->notes[0];
  const auto wide = read_sequence(folder.path(), {.pair_ms = 30});
  ASSERT_TRUE(wide.is_ok());
  EXPECT_EQ(wide->frames[1].depth_path, folder / "d");
  EXPECT_TRUE(wide->notes.empty());
  const auto half = read_sequence(folder.path(), {.pair_ms = 25.2});
  ASSERT_EQ(half->notes.size(), 1U);
  EXPECT_NE(half->notes[0].find("1 of the colour images without depth, typically 25.4 ms"), std::string::npos) << half->notes[0];
}

TEST(Sequence, NotASequence) {
  const TestFolder folder;
  expect_error(read_sequence(folder.path()), ErrorCode::kInvalid, "not a sequence");
  expect_error(read_sequence(folder / "none"), ErrorCode::kNotFound, "no such folder");
  expect_error(read_sequence(folder.write("file", "x")), ErrorCode::kInvalid, "not a folder");
}

TEST(Sequence, SevenScenesInOrderOfNumbers) {
  const TestFolder folder;
  touch(folder, {"frame-000003.color.png", "frame-000000.color.jpg", "frame-000012.color.jpeg", "frame-000003.depth.png",
                 "frame-x.color.png", "notes.txt"});
  const auto sequence = read_sequence(folder.path());
  ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
  EXPECT_EQ(sequence->layout, "7scenes");
  ASSERT_EQ(sequence->frames.size(), 3U);
  EXPECT_EQ(sequence->frames[1].index, 1U);
  EXPECT_EQ(sequence->frames[1].stamp_ns, 100000000);
  EXPECT_EQ(sequence->frames[1].depth_path, folder / "frame-000003.depth.png");
  EXPECT_EQ(sequence->frames[2].stamp_ns, 400000000);
  EXPECT_EQ(sequence->frames[2].depth_path, "");
  EXPECT_EQ(read_sequence(folder.path(), {.frame_rate_hz = 10})->frames[1].stamp_ns, 300000000);
}

TEST(Sequence, SevenScenesTwiceTheSameFrame) {
  const TestFolder folder;
  touch(folder, {"frame-000003.color.png", "frame-000003.color.jpg"});
  expect_error(read_sequence(folder.path()), ErrorCode::kInvalid, "same frame");
}

}  // namespace
}  // namespace camloc
