// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Exchange of maps: the old one stays until the new one is whole.
#include "daemon/map_slot.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "drivers/sample_source.h"
#include "tests/daemon/sample_map.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::SampleMapOptions;
using testing::TestFolder;

class MapSlotTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TestFolder();
    SampleMapOptions options;
    options.num_frames = 30;
    ASSERT_TRUE(testing::write_sample_map(options, folder_->file("a.cmap")));
    options.datum = WcsDatum{};
    options.num_frames = 33;
    ASSERT_TRUE(testing::write_sample_map(options, folder_->file("b.cmap")));
  }
  static void TearDownTestSuite() { delete folder_; }

  static MapSlotOptions options(const std::string& name) {
    MapSlotOptions options;
    options.path = folder_->file(name);
    return options;
  }

  static TestFolder* folder_;
  RgbdCamera camera_ = sample_camera(320, 240);
  MapSlot slot_;
};

TestFolder* MapSlotTest::folder_ = nullptr;

TEST_F(MapSlotTest, LoadedMapLocalizes) {
  ASSERT_TRUE(slot_.load(options("a.cmap"), camera_));
  FrameBuffer frame;
  SampleRoom().render(camera_, sample_pose(10), &frame);
  const Localization& localization = slot_.localizer().process(frame.view());
  EXPECT_EQ(localization.state, State::kLocalized) << to_string(localization.reason);
  EXPECT_LT((localization.T_map_camera.translation - sample_pose(10).translation).norm(), 0.05);
}

TEST_F(MapSlotTest, BadMapKeepsTheOldOne) {
  ASSERT_TRUE(slot_.load(options("a.cmap"), camera_));
  const std::uint64_t id = slot_.info().map_id;
  folder_->write("bad.cmap", "not a map");
  EXPECT_FALSE(slot_.load(options("bad.cmap"), camera_));
  EXPECT_EQ(slot_.load(options("none.cmap"), camera_).code(), ErrorCode::kNotFound);
  EXPECT_FALSE(slot_.load(options(""), camera_)) << "a folder";
  ASSERT_TRUE(slot_.is_loaded());
  EXPECT_EQ(slot_.info().map_id, id);
}

TEST_F(MapSlotTest, GoodMapReplacesTheOldOne) {
  ASSERT_TRUE(slot_.load(options("a.cmap"), camera_));
  const std::uint64_t id = slot_.info().map_id;
  ASSERT_TRUE(slot_.load(options("b.cmap"), camera_));
  EXPECT_NE(slot_.info().map_id, id);
  EXPECT_EQ(slot_.path(), folder_->file("b.cmap"));
}

TEST_F(MapSlotTest, WorldPosesNeedADatum) {
  MapSlotOptions wanted = options("a.cmap");
  wanted.needs_datum = true;
  const Status status = slot_.load(wanted, camera_);
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("georef"), std::string::npos);
  wanted.path = folder_->file("b.cmap");
  EXPECT_TRUE(slot_.load(wanted, camera_));
}

TEST_F(MapSlotTest, OnlyWritingInPlaceIsAnOverwrite) {
  std::filesystem::copy_file(folder_->file("a.cmap"), folder_->file("c.cmap"));
  ASSERT_TRUE(slot_.load(options("c.cmap"), camera_));
  EXPECT_FALSE(slot_.was_overwritten());
  std::filesystem::copy_file(folder_->file("b.cmap"), folder_->file("d.cmap"));
  std::filesystem::rename(folder_->file("d.cmap"), folder_->file("c.cmap"));
  EXPECT_FALSE(slot_.was_overwritten()) << "renamed over: the mapped file is whole";
  ASSERT_TRUE(slot_.load(options("c.cmap"), camera_));
  std::ofstream(folder_->file("c.cmap"), std::ios::app) << "x";
  EXPECT_TRUE(slot_.was_overwritten());
  std::filesystem::remove(folder_->file("c.cmap"));
  EXPECT_FALSE(slot_.was_overwritten());
}

}  // namespace
}  // namespace camloc
