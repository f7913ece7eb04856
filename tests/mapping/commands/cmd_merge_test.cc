// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a person gets who merges maps on the command line: a map, a table, or one line that says what is wrong.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "tests/drivers/test_folder.h"
#include "tests/merge/two_days.h"
#include "tools/camloc-map/commands.h"
#include "tools/common/command_line.h"
#include "tools/mapping/build/merge_pipeline.h"

namespace camloc::mapping {
namespace {

class MergeCommandTest : public ::testing::Test {
 protected:
  MergeCommandTest() {
    const testing::Corridor corridor = testing::make_corridor(1);
    write("a.cmap", testing::make_day(corridor, {}));
    testing::DayOptions second;
    second.seed = 2;
    second.T_day_world.translation = {1, 2, 0};
    write("b.cmap", testing::make_day(corridor, second));
    write("elsewhere.cmap", testing::make_day(testing::make_corridor(9), second));
  }
  void write(const std::string& name, const MapData& map) {
    const Status written = write_map(map, file(name));
    ASSERT_TRUE(written.is_ok()) << written.message();
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  /// Exit code; what was printed is in out_ and error_.
  int run(const std::vector<std::string>& arguments) {
    CLI::App app{"test", "camloc-map"};
    int exit_code = 0;
    add_merge_command(app, exit_code);
    add_build_command(app, exit_code);
    std::vector<const char*> argv = {"camloc-map"};
    for (const std::string& a : arguments) argv.push_back(a.c_str());
    bool is_over = false;
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int usage = tools::parse_command_line(app, static_cast<int>(argv.size()), argv.data(), &is_over);
    out_ = ::testing::internal::GetCapturedStdout();
    error_ = ::testing::internal::GetCapturedStderr();
    return is_over ? usage : exit_code;
  }
  [[nodiscard]] bool has_one_line_of_error() const { return std::count(error_.begin(), error_.end(), '\n') == 1; }

  testing::TemporaryFolder folder_;
  std::string out_, error_;
};

TEST_F(MergeCommandTest, WritesAMapAndSaysWhatCameOfIt) {
  ASSERT_EQ(run({"merge", file("a.cmap"), file("b.cmap"), "--out", file("m.cmap")}), 0) << error_;
  const auto a = MapView::open(file("a.cmap")), merged = MapView::open(file("m.cmap"));
  ASSERT_TRUE(merged.is_ok()) << merged.status().message();
  EXPECT_GT(merged.value().info().num_landmarks, a.value().info().num_landmarks);
  EXPECT_EQ(merged.value().info().name, a.value().info().name);
  EXPECT_NE(out_.find("fused"), std::string::npos);
  EXPECT_TRUE(error_.empty());
}

TEST_F(MergeCommandTest, MayWriteOverTheFirstMapWithinABudget) {
  ASSERT_EQ(run({"merge", file("a.cmap"), file("b.cmap"), "--out", file("a.cmap"), "--max-bytes", "60KB", "--json"}), 0) << error_;
  EXPECT_LE(std::filesystem::file_size(file("a.cmap")), 61440U);
  EXPECT_NE(out_.find("\"localized_keyframes\""), std::string::npos);
  EXPECT_TRUE(MapView::open(file("a.cmap")).is_ok());
}

TEST_F(MergeCommandTest, RefusesWhatDoesNotFitAndLeavesTheOutputAlone) {
  const auto before = testing::read_bytes(file("a.cmap"));
  EXPECT_EQ(run({"merge", file("a.cmap"), file("elsewhere.cmap"), "--out", file("a.cmap")}), 2);
  EXPECT_NE(error_.find("no place in common"), std::string::npos);
  EXPECT_TRUE(has_one_line_of_error());
  EXPECT_EQ(run({"merge", file("a.cmap"), file("a.cmap"), "--out", file("m.cmap")}), 2);
  EXPECT_NE(error_.find("the same map"), std::string::npos);
  EXPECT_EQ(run({"merge", file("a.cmap"), file("b.cmap"), "--out", file("a.cmap"), "--max-bytes", "500"}), 2);
  EXPECT_NE(error_.find("byte budget"), std::string::npos);
  EXPECT_EQ(testing::read_bytes(file("a.cmap")), before);
  EXPECT_FALSE(std::filesystem::exists(file("m.cmap")));
}

TEST_F(MergeCommandTest, RefusesFilesThatAreNoMapsAndOutputsThatCannotBe) {
  auto bytes = testing::read_bytes(file("b.cmap"));
  bytes[bytes.size() / 2] ^= std::byte{1};
  testing::write_bytes(file("damaged.cmap"), bytes);
  EXPECT_EQ(run({"merge", file("a.cmap"), file("damaged.cmap"), "--out", file("m.cmap")}), 1);
  EXPECT_TRUE(has_one_line_of_error());
  EXPECT_NE(error_.find("damaged.cmap"), std::string::npos);
  EXPECT_EQ(run({"merge", file("a.cmap"), file("missing.cmap"), "--out", file("m.cmap")}), 1);
  EXPECT_NE(error_.find("missing.cmap"), std::string::npos);
  EXPECT_EQ(run({"merge", file("a.cmap"), file("b.cmap"), "--out", file("nowhere/m.cmap")}), 2);
  EXPECT_TRUE(has_one_line_of_error());
  EXPECT_EQ(run({"merge", file("a.cmap"), "--out", file("m.cmap")}), 2);
}

using RecordedMergeTest = MergeCommandTest;

TEST_F(RecordedMergeTest, BuildExtendsAMapByAnotherRecordingOfTheRoom) {
  const std::string kitchen = data_folder("kitchen"), camera = (source_folder() / "config/cameras/7scenes.toml").string();
  if (!std::filesystem::exists(kitchen)) GTEST_SKIP() << "no recording " << kitchen;
  const std::vector<std::string> build = {"build", "--sequence", kitchen, "--camera", camera, "--poses", "embedded"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), build.begin(), build.end());
    return more;
  };
  ASSERT_EQ(run(with({"--frames", "0:150:5", "--out", file("k.cmap")})), 0) << error_;
  const auto before = testing::read_bytes(file("k.cmap"));
  EXPECT_EQ(run(with({"--frames", "2:150:5", "--extend", file("missing.cmap"), "--out", file("k.cmap")})), 2);
  EXPECT_NE(error_.find("missing.cmap"), std::string::npos);
  EXPECT_EQ(run(with({"--frames", "2:150:5", "--extend", file("a.cmap"), "--out", file("k.cmap")})), 2);
  EXPECT_NE(error_.find("no place in common"), std::string::npos);
  EXPECT_EQ(testing::read_bytes(file("k.cmap")), before);
  ASSERT_EQ(run(with({"--frames", "2:150:5", "--extend", file("k.cmap"), "--max-bytes", "200KB", "--out", file("k.cmap")})), 0) << error_;
  EXPECT_NE(out_.find("keyframes of the second map"), std::string::npos);
  EXPECT_LE(std::filesystem::file_size(file("k.cmap")), 204800U);
  EXPECT_TRUE(MapView::open(file("k.cmap")).is_ok());
}

}  // namespace
}  // namespace camloc::mapping
