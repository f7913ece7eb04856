// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A map on disk learns which of its places look alike, or stays what it was.
#include "tools/mapping/build/map_upgrade.h"

#include <gtest/gtest.h>

#include "core/io/file_bytes.h"
#include "core/map/map_view.h"
#include "tests/base/recording_observer.h"
#include "tests/mapmaking/bay_map.h"

namespace camloc::mapping {
namespace {

class MapUpgrade : public ::testing::Test {
 protected:
  MapUpgrade() {
    MapData map = testing::make_corridor(3, 12);
    testing::set_keyframes(&map, testing::one_view_a_bay(3));
    EXPECT_TRUE(write_map(map, path_).is_ok());
  }
  [[nodiscard]] static std::string bytes_of(const std::string& path) { return *read_file_text(path); }
  testing::TemporaryFolder folder_;
  std::string path_ = folder_.file("m.cmap"), out_ = folder_.file("out.cmap");
};

TEST_F(MapUpgrade, AddsSectionsAndChangesNothingElse) {
  MapUpgradeSummary summary;
  ASSERT_TRUE(upgrade_map(path_, out_, WorkObserver::nobody(), &summary).is_ok());
  EXPECT_EQ(summary.num_keyframes, 3U);
  EXPECT_EQ(summary.num_with_rivals, 3U);
  EXPECT_EQ(summary.num_landmarks, 900U);
  EXPECT_GT(summary.num_with_twins, 300U);
  const auto before = MapView::open(path_), after = MapView::open(out_);
  ASSERT_TRUE(before.is_ok() && after.is_ok());
  EXPECT_EQ(before->sections().size() + 2, after->sections().size());
  for (const MapSection& section : before->sections()) {
    const auto same = after->section(section.record.id);
    EXPECT_TRUE(std::equal(section.bytes.begin(), section.bytes.end(), same.begin(), same.end()));
  }
}

TEST_F(MapUpgrade, TwiceIsOnce) {
  ASSERT_TRUE(upgrade_map(path_, out_, WorkObserver::nobody()).is_ok());
  ASSERT_TRUE(upgrade_map(path_, path_, WorkObserver::nobody()).is_ok());
  EXPECT_EQ(bytes_of(path_), bytes_of(out_));
  ASSERT_TRUE(upgrade_map(path_, path_, WorkObserver::nobody()).is_ok());
  EXPECT_EQ(bytes_of(path_), bytes_of(out_));
}

TEST_F(MapUpgrade, StoppedOrImpossibleTheMapStaysAsItWas) {
  const auto before = bytes_of(path_);
  testing::RecordingObserver observer(0);
  const Status stopped = upgrade_map(path_, path_, observer);
  EXPECT_EQ(stopped.code(), ErrorCode::kIo);
  EXPECT_NE(stopped.message().find("camloc map upgrade"), std::string::npos) << stopped.message();
  EXPECT_EQ(bytes_of(path_), before);
  EXPECT_EQ(upgrade_map(folder_.file("none.cmap"), out_, WorkObserver::nobody()).code(), ErrorCode::kNotFound);
  EXPECT_FALSE(upgrade_map(path_, folder_.file("no/where.cmap"), WorkObserver::nobody()).is_ok());
}

}  // namespace
}  // namespace camloc::mapping
