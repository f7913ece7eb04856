// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames of a mapped room: where they are, how sure, the same bits each time, without the heap.
#include "core/localize/localizer.h"

#include <gtest/gtest.h>

#include "tests/geometry/allocation_counter.h"
#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

/// Indices of the path that were not mapped.
std::vector<std::uint64_t> query_frames(std::uint64_t step) {
  std::vector<std::uint64_t> indices;
  for (std::uint64_t i = 1; i < testing::kMappedFrames; i += step) {
    if (i % testing::kMapStep != 0) indices.push_back(i);
  }
  return indices;
}

class LocalizerModes : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Modes, LocalizerModes, ::testing::Values(false, true),
                         [](const auto& mode) { return mode.param ? "Tracking" : "EveryFrameKidnapped"; });

TEST_P(LocalizerModes, FindsEveryFrameWithinMillimetres) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()});
  std::uint32_t num_frames = 0;
  for (const std::uint64_t i : query_frames(2)) {
    const Localization& result = localizer.process(world.frame(i).view());
    ++num_frames;
    ASSERT_EQ(result.state, State::kLocalized) << i << ": " << to_string(result.reason);
    EXPECT_EQ(result.reason, Reason::kNone);
    EXPECT_TRUE(result.has_pose);
    EXPECT_EQ(result.sequence, i);
    EXPECT_EQ(result.stamp_ns, static_cast<std::int64_t>(i) * testing::kFrameNs);
    const Vector6d error = pose_error(sample_pose(i), result.T_map_camera);
    EXPECT_LT(error.head<3>().norm(), 0.006) << i;
    EXPECT_LT(error.tail<3>().norm(), 0.003) << i;
    EXPECT_GT(result.quality, 70);
    EXPECT_GT(result.evidence.num_inliers, 300U);
    EXPECT_LE(result.evidence.num_inliers, result.evidence.num_matches);
    EXPECT_LE(result.evidence.num_matches, result.evidence.num_visible);
    EXPECT_GT(result.evidence.spread, 0.5);
    EXPECT_GT(result.evidence.depth_agreement, 0.95);
    EXPECT_GT(result.evidence.map_depth_agreement, 0.95);
    EXPECT_NEAR(result.evidence.focal_scale, 1, 0.01);
    // Tracked frames follow the first, which alone is a global fix; a kidnapped camera is searched for each time.
    const bool is_tracked = GetParam() && num_frames > 1;
    EXPECT_EQ(result.is_tracked, is_tracked) << i;
    EXPECT_EQ(result.reset_counter, GetParam() ? 1 : num_frames) << i;
    EXPECT_EQ(result.jump_m, 0) << "nothing to jump from";
  }
  EXPECT_FALSE(localizer.calibration().is_suspect);
  EXPECT_NEAR(localizer.calibration().focal_scale, 1, 0.005);
}

/// With noise in image and depth the truth lies where the covariance says, and the covariance is not a shrug.
TEST_P(LocalizerModes, CovarianceIsHonest) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()});
  double sum = 0;
  int num_localized = 0;
  for (const std::uint64_t i : query_frames(2)) {
    FrameBuffer frame = world.frame(i);
    testing::add_noise(world.camera(), 6, static_cast<std::uint32_t>(i), &frame);
    const Localization& result = localizer.process(frame.view());
    ASSERT_EQ(result.state, State::kLocalized) << i << ": " << to_string(result.reason);
    const double distance = testing::nees(result, sample_pose(i));
    EXPECT_LT(distance, testing::kNeesLimit) << i;
    EXPECT_GT(result.covariance.ldlt().vectorD().minCoeff(), 0) << i;
    EXPECT_LT((result.covariance - result.covariance.transpose()).cwiseAbs().maxCoeff(), 1e-12) << i;
    EXPECT_LT(std::sqrt(result.covariance.diagonal().head<3>().maxCoeff()), 0.02) << i;
    sum += distance;
    ++num_localized;
  }
  const double mean = sum / num_localized;
  EXPECT_GT(mean, 0.3) << "6 is exact; far below, a caller's filter would ignore the poses";
  EXPECT_LT(mean, 9) << "above 6 the poses are worse than said";
}

TEST_P(LocalizerModes, SaysHowInconsistentTheMapIs) {
  const SampleWorld& world = SampleWorld::get();
  MapData data = world.data();
  data.pose_sigma_m = 0.03;
  data.pose_sigma_rad = 0.01;
  const testing::MapOnDisk rough(data);
  const FrameBuffer frame = world.frame(10);
  Localizer a(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()}),
      b(*rough.view, world.camera(), {.orb = {}, .use_tracking = GetParam()});
  const Matrix6d added = b.process(frame.view()).covariance - a.process(frame.view()).covariance;
  Vector6d variance = Vector6d::Constant(0.03 * 0.03);
  variance.tail<3>().setConstant(0.01 * 0.01);
  // The rest is what landmarks that lie together are off together: never less, and of the same size.
  const Matrix6d shared = added - Matrix6d(variance.asDiagonal());
  EXPECT_GE((shared + 1e-9 * Matrix6d::Identity()).ldlt().vectorD().minCoeff(), 0);
  EXPECT_GT(shared.trace(), 1e-6);
  EXPECT_LT(shared.diagonal().maxCoeff(), 9 * 0.03 * 0.03);
}

TEST_P(LocalizerModes, SameFramesSameBits) {
  const SampleWorld& world = SampleWorld::get();
  Localizer a(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()}),
      b(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()});
  for (const std::uint64_t i : query_frames(6)) {
    FrameBuffer frame = world.frame(i);
    testing::add_noise(world.camera(), 4, static_cast<std::uint32_t>(i), &frame);
    if (i % 4 == 0) std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), std::uint8_t{0});
    const FrameBuffer copy = frame;  // other addresses
    EXPECT_EQ(testing::bits_of(a.process(frame.view())), testing::bits_of(b.process(copy.view()))) << i;
  }
}

TEST_P(LocalizerModes, NeverAllocatesInAFrame) {
  if (!testing::can_count_allocations()) GTEST_SKIP() << "the sanitizer owns the allocator";
  const SampleWorld& world = SampleWorld::get();
  std::vector<FrameBuffer> frames;
  for (const std::uint64_t i : query_frames(4)) frames.push_back(world.frame(i));
  for (std::size_t i = 8; i < 14; ++i) {  // lost in several ways: nothing in the image, another place, no image
    auto& frame = frames[i];
    if (i % 3 == 0) std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), std::uint8_t{0});
    if (i % 3 == 1) testing::mirror(&frame);
    if (i % 3 == 2) frame.gray.resize(0, 0);
  }
  frames[15].depth.resize(0, 0);
  Localizer localizer(world.map(), world.camera(), {.orb = {}, .use_tracking = GetParam()});
  int num_localized = 0;
  for (const auto& frame : frames) {
    const Frame view = frame.view();
    const std::uint64_t before = testing::num_allocations();
    const State state = localizer.process(view).state;
    ASSERT_EQ(testing::num_allocations(), before) << "frame " << frame.sequence << ", " << to_string(state);
    num_localized += state == State::kLocalized ? 1 : 0;
  }
  EXPECT_GE(num_localized, GetParam() ? 10 : 9) << "a single frame without depth may be a picture";
  EXPECT_LT(num_localized, static_cast<int>(frames.size()) - 3);
}

TEST(Localizer, WithoutTrackingNoFrameRemembersAnother) {
  const SampleWorld& world = SampleWorld::get();
  Localizer seasoned(world.map(), world.camera(), {.orb = {}, .use_tracking = false});
  for (const std::uint64_t i : query_frames(8)) {
    FrameBuffer before = world.frame(i + 30);
    if (i % 3 == 1) testing::mirror(&before);
    static_cast<void>(seasoned.process(before.view()));
    const FrameBuffer frame = world.frame(i);
    Localizer fresh(world.map(), world.camera(), {.orb = {}, .use_tracking = false});
    Localization expected = fresh.process(frame.view()), seen = seasoned.process(frame.view());
    EXPECT_GE(seen.reset_counter, expected.reset_counter);
    seen.reset_counter = expected.reset_counter;
    EXPECT_EQ(testing::bits_of(seen), testing::bits_of(expected)) << i;
  }
}

TEST(Localizer, ResetForgetsThePose) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {});
  EXPECT_FALSE(localizer.process(world.frame(1).view()).is_tracked);
  EXPECT_TRUE(localizer.process(world.frame(2).view()).is_tracked);
  localizer.reset();
  const Localization& result = localizer.process(world.frame(4).view());
  EXPECT_EQ(result.state, State::kLocalized);
  EXPECT_FALSE(result.is_tracked);
  EXPECT_EQ(result.reset_counter, 2U);
  EXPECT_TRUE(localizer.process(world.frame(5).view()).is_tracked);

  localizer.reset();
  FrameBuffer black = world.frame(7);
  std::fill(black.gray.pixels.begin(), black.gray.pixels.end(), std::uint8_t{0});
  EXPECT_EQ(localizer.process(black.view()).state, State::kLost) << "nothing to coast on";
}

TEST(Localizer, WorksWithoutDepthImages) {
  const SampleWorld& world = SampleWorld::get();
  Localizer without(world.map(), world.camera(), {}), unused(world.map(), world.camera(), {.orb = {}, .use_depth = false});
  std::uint64_t num_localized = 0;
  for (std::uint64_t i = 0; i < testing::kMappedFrames; ++i) {
    const FrameBuffer buffer = world.frame(i);
    Frame frame = buffer.view();
    const Localization with_option = unused.process(frame);
    frame.depth = {};
    const Localization& result = without.process(frame);
    EXPECT_EQ(testing::bits_of(result), testing::bits_of(with_option)) << "no depth image is the same as none used";
    if (result.state != State::kLocalized) {
      EXPECT_EQ(num_localized, 0U) << i << ": " << to_string(result.reason);
      continue;
    }
    ++num_localized;
    EXPECT_LT(testing::nees(result, sample_pose(i)), testing::kNeesLimit) << i;
  }
  EXPECT_GT(num_localized, testing::kMappedFrames - 60) << "within two seconds, once motion has shown that it is no picture";
}

std::int64_t fake_now_ns() {
  static std::int64_t now_ns = 0;
  return now_ns += 1000;
}

TEST(Localizer, TimesItsStagesWithTheClockItIsGiven) {
  const SampleWorld& world = SampleWorld::get();
  Localizer timed(world.map(), world.camera(), {.orb = {}, .now_ns = fake_now_ns}), plain(world.map(), world.camera(), {});
  const FrameBuffer frame = world.frame(4);
  const Localization& result = timed.process(frame.view());
  std::int64_t sum_ns = 0;
  for (int stage = 0; stage < static_cast<int>(Stage::kTotal); ++stage) {
    EXPECT_GT(result.stage_ns[static_cast<std::size_t>(stage)], 0) << to_string(static_cast<Stage>(stage));
    sum_ns += result.stage_ns[static_cast<std::size_t>(stage)];
  }
  EXPECT_LE(sum_ns, result.stage_ns[static_cast<std::size_t>(Stage::kTotal)]);
  EXPECT_GE(sum_ns + 2000, result.stage_ns[static_cast<std::size_t>(Stage::kTotal)]) << "every reading belongs to a stage";
  const Localization& untimed = plain.process(frame.view());
  for (const std::int64_t ns : untimed.stage_ns) EXPECT_EQ(ns, 0);
  EXPECT_EQ(testing::bits_of(untimed), testing::bits_of(result)) << "the clock changes nothing";
}

}  // namespace
}  // namespace camloc
