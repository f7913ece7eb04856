// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Two maps become one file, watched by an observer, or none is touched.
#include "tools/mapping/build/merge_pipeline.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/map/map_view.h"
#include "tests/base/recording_observer.h"
#include "tests/merge/two_days.h"

namespace camloc::mapping {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class MergePipelineTest : public ::testing::Test {
 protected:
  MergePipelineTest() {
    const testing::Corridor corridor = testing::make_corridor(1);
    testing::DayOptions second;
    second.seed = 2;
    second_ = testing::make_day(corridor, second);
    EXPECT_TRUE(write_map(testing::make_day(corridor, {}), a_).is_ok());
  }
  testing::TemporaryFolder folder_;
  std::string a_ = folder_.file("a.cmap");
  MapData second_;
};

TEST_F(MergePipelineTest, WritesTheMapAndCountsWhatItDoes) {
  testing::RecordingObserver observer;
  MergeSummary summary;
  summary.map_b = "b.cmap";
  ASSERT_TRUE(merge_into(a_, second_, {}, folder_.file("m.cmap"), observer, &summary).is_ok());
  EXPECT_EQ(observer.count("looking for places in common, keyframe"), summary.report.registration.num_queries);
  EXPECT_EQ(observer.count("choosing landmarks and keyframes, training words ..."), 1U);
  EXPECT_EQ(observer.steps.back().what, "look-alikes, keyframe");
  const auto merged = MapView::open(folder_.file("m.cmap"));
  ASSERT_TRUE(merged.is_ok());
  EXPECT_EQ(merged->info().num_landmarks, summary.report.map.num_landmarks);
  const std::string table = format_table(summary);
  EXPECT_TRUE(contains(table, "first map             " + a_ + ": " + std::to_string(summary.report.num_landmarks_a) + " landmarks"))
      << table;
  EXPECT_TRUE(contains(table, std::to_string(summary.report.num_fused) + " fused, " + std::to_string(summary.report.num_added) + " added"))
      << table;
  const auto json = nlohmann::json::parse(format_json(summary), nullptr, false);
  EXPECT_EQ(json["landmarks"]["kept"], summary.report.map.num_landmarks);
  EXPECT_EQ(json["landmarks"]["fused"], summary.report.num_fused);
  EXPECT_EQ(json["localized_keyframes"], summary.report.num_localized);
  EXPECT_EQ(json["second"]["map"], "b.cmap");
}

TEST_F(MergePipelineTest, StoppedAnywhereItLeavesTheMap) {
  const auto before = testing::read_bytes(a_);
  testing::RecordingObserver all;
  MergeSummary summary;
  ASSERT_TRUE(merge_into(a_, second_, {}, folder_.file("m.cmap"), all, &summary).is_ok());
  for (const std::size_t steps : {std::size_t{1}, all.steps.size() / 2, all.steps.size()}) {
    testing::RecordingObserver observer(steps);
    EXPECT_EQ(merge_into(a_, second_, {}, a_, observer, &summary).code(), ErrorCode::kIo) << steps;
    EXPECT_EQ(observer.steps.size(), steps);
    EXPECT_EQ(testing::read_bytes(a_), before);
  }
}

}  // namespace
}  // namespace camloc::mapping
