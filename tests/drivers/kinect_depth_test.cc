// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "drivers/kinect/kinect_protocol.h"
#include "drivers/raw_pixels.h"

namespace camloc::kinect {
namespace {

constexpr std::size_t kNumPixels = static_cast<std::size_t>(kWidth) * kHeight;

KinectCalibration calibrated() {
  KinectCalibration calibration;
  calibration.zero_plane = ZeroPlane{};
  calibration.const_shift = 200;
  return calibration;
}

/// A displacement by `dx`, `dy` pixels everywhere: only the constant terms.
RegistrationBlock constant_block(double dx, double dy) {
  RegistrationBlock block;
  block.x.start = static_cast<std::int32_t>(std::lround(dx * 256));  // fixed point, 8 bits
  block.y.start = static_cast<std::int32_t>(std::lround(dy * 256));
  return block;
}

/// The published coefficients of one Kinect (OpenKinect), with which displacements of 17 to 31 pixels are known to come out.
RegistrationBlock real_block() {
  return {{1964, 56, -26, 600, 6161, 2095986, 763, 134215474, 134217093, 134216984},
          {-13, 2825, 684, 5, 6434, 890, 2096378, 134216989, 134216925, 134214659}};
}

TEST(KinectDepth, FullFrameUnpacksLikeBitByBit) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> packed(kDepthFrameBytes);
  for (std::uint8_t& byte : packed) byte = static_cast<std::uint8_t>(random());
  std::vector<std::uint16_t> pixels(kNumPixels);
  unpack_pixels(packed.data(), kNumPixels, 11, pixels.data());
  for (std::size_t i = 0; i < kNumPixels; i += 7) {
    std::uint16_t expected = 0;
    for (std::size_t bit = 11 * i; bit < 11 * i + 11; ++bit)
      expected = static_cast<std::uint16_t>(expected << 1 | (packed[bit / 8] >> (7 - bit % 8) & 1));
    ASSERT_EQ(pixels[i], expected) << i;
  }
}

TEST(KinectDepth, ReferencePlaneLiesAtItsDistance) {
  // Disparity 0 (raw 800 and the offset of the correlation window) is the reference plane: 1.2 m.
  const DepthTable table = make_depth_table(calibrated());
  EXPECT_NEAR(table[801], 1197, 3);
  EXPECT_NEAR(table[802], 1201, 3);
}

TEST(KinectDepth, TablesRiseAndEndInNothing) {
  for (const KinectCalibration& calibration : {calibrated(), KinectCalibration{}}) {
    const DepthTable table = make_depth_table(calibration);
    EXPECT_EQ(table[kNoDisparity], 0);
    EXPECT_EQ(table[1500], 0) << "behind the pole";
    int last = 0;
    bool has_ended = false;
    for (std::size_t raw = 330; raw < kNumDisparities; ++raw) {
      if (table[raw] == 0) {
        has_ended = true;
      } else {
        EXPECT_FALSE(has_ended) << raw;
        EXPECT_GE(table[raw], last) << raw;
        last = table[raw];
      }
    }
    EXPECT_GT(last, 7000);
    EXPECT_LT(last, kMaxDepthMm);
  }
}

TEST(KinectDepth, PublicModelAgreesWithATypicalDevice) {
  const DepthTable device = make_depth_table(calibrated()), general = make_depth_table({});
  for (std::size_t raw = 500; raw <= 950; raw += 50) EXPECT_NEAR(general[raw], device[raw], 0.07 * device[raw]) << raw;
}

TEST(KinectDepth, ConversionLooksUpEveryPixel) {
  const DepthTable table = make_depth_table(calibrated());
  std::vector<std::uint16_t> raw(kNumDisparities), millimetres(kNumDisparities);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint16_t>(i);
  convert_depth(raw, table, millimetres.data());
  EXPECT_TRUE(std::equal(millimetres.begin(), millimetres.end(), table.begin()));
}

TEST(KinectRegistration, NeedsBlockAndZeroPlane) {
  KinectCalibration calibration = calibrated();
  const DepthTable table = make_depth_table(calibration);
  EXPECT_FALSE(DepthRegistration::create(calibration, table));
  calibration.registration = constant_block(0, 0);
  EXPECT_TRUE(DepthRegistration::create(calibration, table));
  calibration.registration = constant_block(900, 0);
  EXPECT_FALSE(DepthRegistration::create(calibration, table)) << "out of the image";
  calibration.registration = real_block();
  calibration.zero_plane.reset();
  EXPECT_FALSE(DepthRegistration::create(calibration, table));
}

TEST(KinectRegistration, SurfacesShiftByBaselineTimesFocalLengthOverDistance) {
  KinectCalibration calibration = calibrated();
  calibration.registration = constant_block(5, -3);
  const DepthTable table = make_depth_table(calibration);
  const auto registration = DepthRegistration::create(calibration, table);
  ASSERT_TRUE(registration);
  const ZeroPlane& plane = *calibration.zero_plane;
  for (const std::uint16_t disparity : {std::uint16_t{600}, std::uint16_t{800}, std::uint16_t{950}}) {
    std::vector<std::uint16_t> raw(kNumPixels, kNoDisparity);
    raw[200 * kWidth + 300] = disparity;
    Image<std::uint16_t> registered;
    registration->apply(raw, &registered);
    const auto hit = std::find_if(registered.pixels.begin(), registered.pixels.end(), [](std::uint16_t mm) { return mm != 0; });
    ASSERT_NE(hit, registered.pixels.end());
    const auto at = static_cast<int>(hit - registered.pixels.begin());
    EXPECT_EQ(*hit, table[disparity]);
    EXPECT_EQ(std::count(registered.pixels.begin(), registered.pixels.end(), 0), static_cast<std::ptrdiff_t>(kNumPixels - 1));
    const double parallax_px = plane.color_distance_cm * 10 * plane.focal_px() / *hit;
    const double at_infinity_px = plane.color_distance_cm * 10 * plane.focal_px() / (10 * plane.reference_distance_cm);
    EXPECT_NEAR(at % kWidth, 300 + 5 + 1 + at_infinity_px - parallax_px, 1.5) << "nearer: further to the left in the colour image";
    EXPECT_EQ(at / kWidth, 200 - 3 + 1);
  }
}

TEST(KinectRegistration, RealCoefficientsGiveASmoothMapOfTheWholeImage) {
  KinectCalibration calibration = calibrated();
  calibration.registration = real_block();
  const DepthTable table = make_depth_table(calibration);
  const auto registration = DepthRegistration::create(calibration, table);
  ASSERT_TRUE(registration);
  const std::vector<std::uint16_t> wall(kNumPixels, 900);
  Image<std::uint16_t> registered;
  registration->apply(wall, &registered);
  const auto num_hit = std::count_if(registered.pixels.begin(), registered.pixels.end(), [](std::uint16_t mm) { return mm != 0; });
  EXPECT_GT(static_cast<double>(num_hit), 0.75 * kNumPixels)
      << "the colour camera sees wider: a frame stays empty, the inside has no holes";
  for (int y = 60; y < 420; ++y) {
    for (int x = 80; x < 560; ++x) ASSERT_EQ(registered.at(x, y), table[900]) << x << ' ' << y;
  }
}

TEST(KinectRegistration, NearerSurfaceHidesTheFarther) {
  KinectCalibration calibration = calibrated();
  calibration.registration = constant_block(0, 0);
  const DepthTable table = make_depth_table(calibration);
  const auto registration = DepthRegistration::create(calibration, table);
  ASSERT_TRUE(registration);
  std::vector<std::uint16_t> raw(kNumPixels, 950);  // a wall, before it a block
  for (int x = 300; x < 340; ++x) raw[static_cast<std::size_t>(240 * kWidth + x)] = 600;
  Image<std::uint16_t> registered;
  registration->apply(raw, &registered);
  const std::uint16_t* row = registered.row(241);
  EXPECT_EQ(std::count(row, row + kWidth, table[600]), 40);
  // Where the block hid the wall from the depth camera the colour camera sees it: no depth there.
  EXPECT_GT(std::count(row, row + kWidth, 0), 5 + std::count(registered.row(100), registered.row(101), 0));
}

TEST(KinectRegistration, WildCoefficientsAreSafe) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    std::vector<std::uint8_t> body(kRegistrationBodyBytes);
    for (std::uint8_t& byte : body) byte = static_cast<std::uint8_t>(random());
    KinectCalibration calibration = calibrated();
    calibration.registration = parse_registration(body);
    ASSERT_TRUE(calibration.registration);
    const auto registration = DepthRegistration::create(calibration, make_depth_table(calibration));
    if (!registration) continue;
    Image<std::uint16_t> registered;
    registration->apply(std::vector<std::uint16_t>(kNumPixels, 700), &registered);
  }
}

}  // namespace
}  // namespace camloc::kinect
