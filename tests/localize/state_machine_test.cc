// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the localizer says from frame to frame: coasting, lost, found again, jumps, a clock that runs backwards, a map
// that vanishes.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/map/mapping_guard.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

FrameBuffer black(std::uint64_t sequence) {
  FrameBuffer frame = SampleWorld::get().frame(0, sequence);
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), std::uint8_t{0});
  return frame;
}

/// The sample map, where what lies in the left half of a frame's image is 20 m away once more.
MapData with_copy_of_left_half(std::uint64_t index) {
  const Rigid3 T_camera_map = sample_pose(index).inverse();
  return testing::with_copy({20, 0, 0}, [&](std::uint32_t, const Eigen::Vector3d& p_map) {
    const Eigen::Vector3d p = T_camera_map * p_map;
    return p.z() <= 0 || p.x() < 0.05 * p.z();
  });
}

class StateMachine : public ::testing::Test {
 protected:
  const Localization& see(std::uint64_t index, std::uint64_t sequence) {
    const FrameBuffer frame = world_.frame(index, sequence);
    return localizer_.process(frame.view());
  }
  const Localization& see(std::uint64_t index) { return see(index, index); }

  const SampleWorld& world_ = SampleWorld::get();
  Localizer localizer_{world_.map(), world_.camera(), {}};
};

TEST_F(StateMachine, CoastsThenIsLost) {
  for (std::uint64_t i = 0; i <= 10; ++i) ASSERT_EQ(see(i).state, State::kLocalized);
  const std::int64_t last_ns = 10 * testing::kFrameNs;
  double position_variance = 0, rotation_variance = 0;
  int num_coasting = 0, num_lost = 0;
  for (std::uint64_t i = 11; i < 40; ++i) {
    const Localization& result = localizer_.process(black(i).view());
    EXPECT_EQ(result.reason, Reason::kFewFeatures);
    EXPECT_EQ(result.evidence.num_inliers, 0U);
    EXPECT_EQ(result.reset_counter, 1U);
    if (result.stamp_ns - last_ns > 500'000'000) {
      EXPECT_EQ(result.state, State::kLost) << i;
      EXPECT_FALSE(result.has_pose);
      EXPECT_EQ(result.quality, -1);
      ++num_lost;
      continue;
    }
    ++num_coasting;
    ASSERT_EQ(result.state, State::kCoasting) << i;
    EXPECT_TRUE(result.has_pose);
    EXPECT_EQ(result.quality, 0);
    const Vector6d variance = result.covariance.diagonal();
    EXPECT_GT(variance.head<3>().sum(), position_variance);
    EXPECT_GT(variance.tail<3>().sum(), rotation_variance);
    EXPECT_LT(testing::nees(result, sample_pose(i)), testing::kNeesLimit) << "the path is smooth";
    position_variance = variance.head<3>().sum();
    rotation_variance = variance.tail<3>().sum();
  }
  EXPECT_EQ(num_coasting, 15);
  EXPECT_EQ(num_lost, 14);
  EXPECT_GT(std::sqrt(position_variance), 0.1) << "after half a second";
}

TEST_F(StateMachine, CoastingTimeIsAnOption) {
  Localizer localizer(world_.map(), world_.camera(), {.orb = {}, .max_coast_ns = 2 * testing::kFrameNs});
  ASSERT_EQ(localizer.process(world_.frame(1).view()).state, State::kLocalized);
  EXPECT_EQ(localizer.process(black(2).view()).state, State::kCoasting);
  EXPECT_EQ(localizer.process(black(3).view()).state, State::kCoasting);
  EXPECT_EQ(localizer.process(black(4).view()).state, State::kLost);
}

/// The image of a frame with nothing but a window of it, from column `left` to before `right`.
FrameBuffer window(std::uint64_t index, std::uint64_t sequence, int left, int right) {
  FrameBuffer frame = SampleWorld::get().frame(index, sequence);
  for (int v = 0; v < frame.gray.height; ++v) {
    for (int u = 0; u < frame.gray.width; ++u) {
      const bool is_inside = u >= left && u < right && v >= 72 && v < 172;
      if (!is_inside) frame.gray.pixels[static_cast<std::size_t>(v * frame.gray.width + u)] = 0;
    }
  }
  return frame;
}

// A place that looked like another one a moment ago is not believed just because the rival is not in view any more.
TEST_F(StateMachine, AThinFixIsNotBelievedRightAfterAnAmbiguousOne) {
  constexpr std::uint64_t kSeen = 20;
  const testing::MapOnDisk map(with_copy_of_left_half(kSeen));
  ASSERT_NE(map.view, nullptr);
  Localizer localizer(*map.view, world_.camera(), {});
  const auto whole = [&](std::uint64_t sequence) { return localizer.process(world_.frame(kSeen, sequence).view()); };
  const auto left_half = [&](std::uint64_t sequence) { return localizer.process(window(kSeen, sequence, 5, 150).view()); };
  const auto right_half = [&](std::uint64_t sequence) { return localizer.process(window(kSeen, sequence, 208, 308).view()); };

  ASSERT_EQ(whole(1).state, State::kLocalized);
  const Localization alone = right_half(37);  // 1.2 s later
  EXPECT_EQ(alone.state, State::kLocalized);
  EXPECT_LT(alone.evidence.num_inliers, LocalizerNumbers{}.strong_inliers);

  localizer.reset();
  ASSERT_EQ(whole(41).state, State::kLocalized);
  EXPECT_EQ(left_half(76).reason, Reason::kAmbiguous);
  EXPECT_EQ(right_half(77).reason, Reason::kAmbiguous);
  EXPECT_EQ(right_half(105).reason, Reason::kAmbiguous);
  EXPECT_EQ(right_half(120).state, State::kLocalized) << "1.5 s are enough";
}

// Much evidence, or a motion that is known, needs no patience.
TEST_F(StateMachine, AStrongFixIsBelievedRightAfterAnAmbiguousOne) {
  constexpr std::uint64_t kSeen = 20;
  const testing::MapOnDisk map(with_copy_of_left_half(kSeen));
  ASSERT_NE(map.view, nullptr);
  Localizer localizer(*map.view, world_.camera(), {});
  ASSERT_EQ(localizer.process(world_.frame(kSeen, 1).view()).state, State::kLocalized);
  EXPECT_EQ(localizer.process(window(kSeen, 37, 5, 150).view()).reason, Reason::kAmbiguous);
  EXPECT_EQ(localizer.process(world_.frame(kSeen, 38).view()).state, State::kLocalized);
}

TEST_F(StateMachine, TracksOnAfterAShortGap) {
  see(1);
  see(2);
  for (std::uint64_t i = 3; i < 8; ++i) static_cast<void>(localizer_.process(black(i).view()));
  const Localization& result = see(8);
  EXPECT_EQ(result.state, State::kLocalized);
  EXPECT_TRUE(result.is_tracked);
  EXPECT_EQ(result.reset_counter, 1U);
}

TEST_F(StateMachine, SearchesTheWholeMapAfterALongGap) {
  see(1);
  for (std::uint64_t i = 2; i < 40; ++i) static_cast<void>(localizer_.process(black(i).view()));
  const Localization& result = see(70);
  EXPECT_EQ(result.state, State::kLocalized);
  EXPECT_FALSE(result.is_tracked);
  EXPECT_EQ(result.reset_counter, 2U);
  EXPECT_NEAR(result.jump_m, (sample_pose(70).translation - sample_pose(1).translation).norm(), 0.02);
  EXPECT_LT(testing::nees(result, sample_pose(70)), testing::kNeesLimit);
  const Localization& next = see(71);
  EXPECT_TRUE(next.is_tracked);
  EXPECT_EQ(next.jump_m, 0);
}

TEST_F(StateMachine, WithoutTrackingNothingIsRemembered) {
  Localizer localizer(world_.map(), world_.camera(), {.orb = {}, .use_tracking = false});
  ASSERT_EQ(localizer.process(world_.frame(1).view()).state, State::kLocalized);
  const Localization& lost = localizer.process(black(2).view());
  EXPECT_EQ(lost.state, State::kLost);
  EXPECT_FALSE(lost.has_pose);
  const Localization& far = localizer.process(world_.frame(80, 3).view());
  EXPECT_EQ(far.state, State::kLocalized) << "a kidnapped camera may be anywhere";
  EXPECT_EQ(far.jump_m, 0);
}

/// From frame 5 of the path to frame 60 in 33 ms: half a metre, and a turn.
TEST_F(StateMachine, AJumpIsBelievedOnlyWhenSeenAgain) {
  for (std::uint64_t i = 0; i <= 5; ++i) see(i);
  const Localization& first = see(60, 6);
  EXPECT_EQ(first.state, State::kCoasting);
  EXPECT_EQ(first.reason, Reason::kImplausibleMotion);
  EXPECT_LT((first.T_map_camera.translation - sample_pose(6).translation).norm(), 0.05) << "coasts on the old path";
  EXPECT_EQ(first.reset_counter, 1U);
  bool is_believed = false;
  for (std::uint64_t sequence = 7; sequence < 50 && !is_believed; ++sequence) {
    const std::uint64_t index = 60 + (sequence - 6) / 2;
    const Localization& result = see(index, sequence);
    is_believed = result.state == State::kLocalized;
    if (!is_believed) {
      EXPECT_EQ(result.reason, Reason::kImplausibleMotion) << sequence;
      EXPECT_EQ(result.reset_counter, 1U) << sequence;
      continue;
    }
    EXPECT_FALSE(result.is_tracked);
    EXPECT_EQ(result.reset_counter, 2U);
    EXPECT_GT(result.jump_m, 0.3);
    EXPECT_LT(testing::nees(result, sample_pose(index)), testing::kNeesLimit);
    EXPECT_TRUE(see(index, sequence + 1).is_tracked);
  }
  EXPECT_TRUE(is_believed) << "within one and a half seconds";
}

TEST_F(StateMachine, TwoDifferentJumpsDoNotConfirmEachOther) {
  for (std::uint64_t i = 0; i <= 2; ++i) see(i);
  EXPECT_EQ(see(90, 3).reason, Reason::kImplausibleMotion);
  EXPECT_EQ(see(45, 4).reason, Reason::kImplausibleMotion);
  EXPECT_EQ(see(89, 5).reason, Reason::kImplausibleMotion);
  EXPECT_TRUE(see(6).is_tracked) << "the path it was on goes on";
  EXPECT_EQ(see(89, 7).reason, Reason::kImplausibleMotion) << "and the looks before are forgotten";
}

TEST_F(StateMachine, TimeRunningBackwardsStartsAnew) {
  for (std::uint64_t i = 40; i <= 42; ++i) see(i);
  const Localization& back = see(10);
  EXPECT_EQ(back.state, State::kLocalized);
  EXPECT_FALSE(back.is_tracked);
  EXPECT_EQ(back.reset_counter, 2U);
  EXPECT_TRUE(see(11).is_tracked);
  const Localization& again = see(11);
  EXPECT_EQ(again.state, State::kLocalized) << "the same stamp twice";
  EXPECT_TRUE(testing::is_finite(again));
  EXPECT_EQ(again.reset_counter, 3U);
  const Localization& lost = localizer_.process(black(5).view());
  EXPECT_EQ(lost.state, State::kLost) << "coasting into the past makes no sense";
}

TEST_F(StateMachine, CounterGrowsOnlyWithGlobalFixes) {
  std::uint32_t counter = 0;
  for (std::uint64_t sequence = 1; sequence < 150; ++sequence) {
    const bool is_dark = sequence % 40 < 12, is_long_dark = sequence > 60 && sequence < 100;
    const Localization& result = is_dark || is_long_dark ? localizer_.process(black(sequence).view()) : see(sequence / 2, sequence);
    const bool is_global_fix = result.state == State::kLocalized && !result.is_tracked;
    ASSERT_EQ(result.reset_counter, counter + (is_global_fix ? 1 : 0)) << sequence;
    if (!is_global_fix) { ASSERT_EQ(result.jump_m, 0) << sequence; }
    counter = result.reset_counter;
  }
  EXPECT_EQ(counter, 2U);
}

/// Bytes of the map go away under the localizer, as when another program truncates the file.
TEST_F(StateMachine, SaysThatTheMapIsDamaged) {
  ASSERT_TRUE(install_mapping_guard());
  const testing::MapOnDisk on_disk(world_.data());
  Localizer localizer(*on_disk.view, world_.camera(), {});
  ASSERT_EQ(localizer.process(world_.frame(1).view()).state, State::kLocalized);
  ASSERT_EQ(localizer.process(world_.frame(2).view()).state, State::kLocalized);
  std::filesystem::resize_file(on_disk.path, 4096);
  const Localization& during = localizer.process(world_.frame(4).view());
  EXPECT_NE(during.state, State::kLocalized) << "landmarks and descriptors read as zeros";
  EXPECT_TRUE(testing::is_finite(during));
  ASSERT_TRUE(on_disk.view->is_damaged());
  const Localization& after = localizer.process(world_.frame(5).view());
  EXPECT_EQ(after.reason, Reason::kMapDamaged);
  EXPECT_EQ(after.state, State::kCoasting);
  EXPECT_EQ(after.num_features, 0U) << "this frame was not looked at";
  const Localization& later = localizer.process(world_.frame(40).view());
  EXPECT_EQ(later.reason, Reason::kMapDamaged);
  EXPECT_EQ(later.state, State::kLost);
}

/// Half of the map goes: whatever still matches, nothing is LOCALIZED that is not true.
TEST_F(StateMachine, HalfAMapTellsNoLies) {
  ASSERT_TRUE(install_mapping_guard());
  const testing::MapOnDisk on_disk(world_.data());
  Localizer localizer(*on_disk.view, world_.camera(), {});
  const auto bytes = std::filesystem::file_size(on_disk.path);
  for (const double share : {0.9, 0.6, 0.4}) {
    std::filesystem::resize_file(on_disk.path, static_cast<std::uintmax_t>(share * static_cast<double>(bytes)));
    const FrameBuffer frame = world_.frame(20);
    const Localization& result = localizer.process(frame.view());
    if (result.state == State::kLocalized) { EXPECT_LT(testing::nees(result, sample_pose(20)), testing::kNeesLimit) << share; }
    localizer.reset();
  }
  EXPECT_TRUE(on_disk.view->is_damaged());
}

}  // namespace
}  // namespace camloc
