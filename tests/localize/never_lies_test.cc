// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Whatever the camera delivers, a pose that is called LOCALIZED is right: its covariance does not exclude the truth.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/localize/sample_world.h"

namespace camloc {
namespace {

using testing::SampleWorld;

constexpr std::size_t kPixels = 320 * 240;

/// Never LOCALIZED, never NaN; before it and after it the same localizer does its work.
void expect_never_localized(const Frame& frame, const char* what) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {});
  const Localization& lost = localizer.process(frame);
  EXPECT_NE(lost.state, State::kLocalized) << what;
  EXPECT_NE(lost.reason, Reason::kNone) << what;
  EXPECT_EQ(lost.has_pose, lost.state != State::kLost) << what;
  EXPECT_TRUE(testing::is_finite(lost)) << what;

  const FrameBuffer good = world.frame(10);
  localizer.reset();
  EXPECT_EQ(localizer.process(good.view()).state, State::kLocalized) << what;
  Frame later = frame;
  later.stamp_ns = good.stamp_ns + testing::kFrameNs;
  const Localization& coasting = localizer.process(later);
  EXPECT_EQ(coasting.state, State::kCoasting) << what;
  EXPECT_TRUE(testing::is_finite(coasting)) << what;
}

TEST(NeverLies, ImagesOfNothing) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer sample = world.frame(10);
  for (const int grey : {0, 1, 127, 255}) {
    FrameBuffer frame = sample;
    std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), static_cast<std::uint8_t>(grey));
    expect_never_localized(frame.view(), "constant grey");
  }
  testing::Random random(7);
  FrameBuffer noise = sample;
  for (auto& pixel : noise.gray.pixels) pixel = static_cast<std::uint8_t>(random.below(256));
  expect_never_localized(noise.view(), "noise, depth of the room");
  for (auto& value : noise.depth.pixels) value = static_cast<std::uint16_t>(random.below(65536));
  expect_never_localized(noise.view(), "noise, depth too");
  FrameBuffer stripes = sample;
  for (std::size_t i = 0; i < kPixels; ++i) stripes.gray.pixels[i] = (i % 320 / 8 + i / 320 / 8) % 2 == 0 ? 30 : 220;
  expect_never_localized(stripes.view(), "a chequerboard");
}

TEST(NeverLies, ImagesOfTheWrongShape) {
  const SampleWorld& world = SampleWorld::get();
  const FrameBuffer sample = world.frame(10);
  Frame frame = sample.view();
  frame.gray.height = 1;
  expect_never_localized(frame, "one pixel high");
  frame = sample.view();
  frame.gray.width = 319;
  expect_never_localized(frame, "a column short");
  frame = sample.view();
  frame.gray = {};
  expect_never_localized(frame, "no image");
  frame.depth = {};
  expect_never_localized(frame, "nothing at all");
  FrameBuffer large = sample;
  large.gray.resize(640, 480);
  expect_never_localized(large.view(), "of another camera");
}

TEST(NeverLies, PlacesThatAreNotInTheMap) {
  const SampleWorld& world = SampleWorld::get();
  for (std::uint64_t i = 0; i < testing::kMappedFrames; i += 15) {
    FrameBuffer frame = world.frame(i);
    testing::mirror(&frame);
    expect_never_localized(frame.view(), "the room in a mirror");
    frame = world.frame(i);
    std::reverse(frame.gray.pixels.begin(), frame.gray.pixels.end());
    for (auto& pixel : frame.gray.pixels) pixel = static_cast<std::uint8_t>(255 - pixel);
    expect_never_localized(frame.view(), "a negative, upside down");
    for (const int tile_px : {16, 40, 80}) {
      frame = world.frame(i);
      testing::shuffle_tiles(tile_px, static_cast<std::uint32_t>(i), &frame);
      expect_never_localized(frame.view(), "shuffled");
    }
  }
}

/// A pose is right or not given.
void expect_truth(Localizer* localizer, const FrameBuffer& frame, std::uint64_t index, int* num_localized) {
  const Localization& result = localizer->process(frame.view());
  EXPECT_TRUE(testing::is_finite(result)) << index;
  if (result.state != State::kLocalized) return;
  ++*num_localized;
  EXPECT_LT(testing::nees(result, sample_pose(index)), testing::kNeesLimit) << "frame " << index;
}

/// The whole path, of which a sixth is mapped: no lie where the camera looks at what no map knows, or only the edge of it.
TEST(NeverLies, TheRestOfTheRoom) {
  const SampleWorld& world = SampleWorld::get();
  Localizer kidnapped(world.map(), world.camera(), {.orb = {}, .use_tracking = false}), tracking(world.map(), world.camera(), {});
  int num_localized = 0, num_behind = 0;
  for (std::uint64_t i = 1; i < kSamplePeriod; i += 10) {
    const bool is_behind = i > 250 && i < 400;
    int* counter = is_behind ? &num_behind : &num_localized;
    const FrameBuffer frame = world.frame(i);
    expect_truth(&kidnapped, frame, i, counter);
    expect_truth(&tracking, frame, i, counter);
  }
  EXPECT_EQ(num_behind, 0) << "the camera looks away from all that is mapped";
  EXPECT_GT(num_localized, 18);
}

TEST(NeverLies, ImagesOfOnePlaceWithDepthOfAnother) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {.orb = {}, .use_tracking = false});
  int num_localized = 0;
  for (std::uint64_t i = 0; i + 45 < testing::kMappedFrames; i += 5) {
    FrameBuffer frame = world.frame(i);
    frame.depth = world.frame(i + 45).depth;
    expect_truth(&localizer, frame, i, &num_localized);
  }
}

TEST(NeverLies, DepthThatSaysNothing) {
  const SampleWorld& world = SampleWorld::get();
  for (const int raw : {0, 65535, 1}) {
    Localizer localizer(world.map(), world.camera(), {});
    int num_localized = 0;
    for (std::uint64_t i = 1; i < testing::kMappedFrames; ++i) {
      FrameBuffer frame = world.frame(i);
      std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), static_cast<std::uint16_t>(raw));
      expect_truth(&localizer, frame, i, &num_localized);
    }
    EXPECT_GE(num_localized, static_cast<int>(testing::kMappedFrames) - 60) << "within two seconds, and then always; depth " << raw;
  }
}

/// Frames as a camera without depth gives them: `index(k)` of the path is what it sees at its k-th frame. How many are localized.
int num_localized_without_depth(bool use_tracking, const std::function<std::uint64_t(std::uint64_t)>& index) {
  const SampleWorld& world = SampleWorld::get();
  Localizer localizer(world.map(), world.camera(), {.orb = {}, .use_tracking = use_tracking, .use_depth = false});
  int num_localized = 0;
  for (std::uint64_t k = 0; k < 60; ++k) {
    const FrameBuffer frame = world.frame(index(k), k);
    const Localization& result = localizer.process(frame.view());
    num_localized += result.state == State::kLocalized ? 1 : 0;
    if (result.state != State::kLocalized) {
      EXPECT_EQ(result.reason, Reason::kNoParallax) << k;
      EXPECT_EQ(result.state, State::kCoarse) << k;
      EXPECT_LT((result.T_map_camera.translation - sample_pose(index(k)).translation).norm(), 0.1) << "a place to look at, though";
    }
  }
  return num_localized;
}

TEST(NeverLies, AStillPictureWithoutDepthIsNoPlace) {
  EXPECT_EQ(num_localized_without_depth(true, [](std::uint64_t) { return 31; }), 0);
}

TEST(NeverLies, SingleFramesWithoutDepthMayAllBePictures) {
  EXPECT_EQ(num_localized_without_depth(false, [](std::uint64_t k) { return k; }), 0);
}

TEST(NeverLies, MotionShowsThatItIsThePlace) {
  EXPECT_GE(num_localized_without_depth(true, [](std::uint64_t k) { return k; }), 10) << "of the first two seconds";
}

TEST(NeverLies, DepthThatContradicts) {
  const SampleWorld& world = SampleWorld::get();
  for (const int raw : {400, 1500, 7900}) {
    FrameBuffer frame = world.frame(31);
    std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), static_cast<std::uint16_t>(raw));
    Localizer localizer(world.map(), world.camera(), {});
    const Localization& result = localizer.process(frame.view());
    const bool is_lie = result.state == State::kLocalized && testing::nees(result, sample_pose(31)) > testing::kNeesLimit;
    EXPECT_FALSE(is_lie) << raw;
  }
}

struct WrongCamera {
  double focal, depth;  ///< factors on the camera file
};

/// Frames localized with a camera file that is wrong.
void expect_noticed(const WrongCamera& wrong, bool use_tracking) {
  const SampleWorld& world = SampleWorld::get();
  RgbdCamera camera = world.camera();
  camera.color.fx *= wrong.focal;
  camera.color.fy *= wrong.focal;
  camera.depth = camera.color;
  camera.depth_unit_m *= wrong.depth;
  Localizer localizer(world.map(), camera, {.orb = {}, .use_tracking = use_tracking});
  int num_frames = 0, num_localized = 0;
  for (std::uint64_t i = 1; i < testing::kMappedFrames && num_frames < 30; i += 2) {
    expect_truth(&localizer, world.frame(i), i, &num_localized);
    ++num_frames;
  }
  EXPECT_TRUE(localizer.calibration().is_suspect) << "focal * " << wrong.focal << ", depth * " << wrong.depth;
  if (wrong.depth == 1) { EXPECT_NEAR(localizer.calibration().focal_scale, 1 / wrong.focal, 0.01); }
}

TEST(NeverLies, FocalLengthOfAnotherCamera) {
  for (const double focal : {450.0 / 525, 585.0 / 525}) {
    expect_noticed({focal, 1}, true);
    expect_noticed({focal, 1}, false);
  }
}

TEST(NeverLies, DepthScaleOfAnotherCamera) {
  for (const double scale : {0.8, 1.2}) {
    expect_noticed({1, scale}, true);
    expect_noticed({1, scale}, false);
  }
}

}  // namespace
}  // namespace camloc
