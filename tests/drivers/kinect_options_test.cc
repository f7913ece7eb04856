// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "drivers/kinect/kinect_options.h"

#include <gtest/gtest.h>

#include "core/geometry/gravity.h"
#include "drivers/kinect/kinect_motor.h"
#include "drivers/sources.h"

namespace camloc::kinect {
namespace {

Result<KinectOptions> options_of(const std::string& url) { return parse_kinect_options(*parse_source_url(url)); }

TEST(KinectOptions, DefaultsLeaveTheDeviceAlone) {
  const Result<KinectOptions> options = options_of("kinect://");
  ASSERT_TRUE(options.is_ok()) << options.status().message();
  EXPECT_TRUE(options->selector.empty());
  EXPECT_EQ(options->depth, DepthMode::kRegistered);
  EXPECT_FALSE(options->color.auto_exposure || options->color.auto_white_balance || options->color.exposure_us || options->color.gain);
  EXPECT_TRUE(options->is_led_status);
  EXPECT_FALSE(options->tilt_deg);
}

TEST(KinectOptions, EverythingCanBeSet) {
  const Result<KinectOptions> options =
      options_of("kinect://A00362A08602047A?depth=raw&exposure_us=8000&gain=2.5&white_balance=manual&led=off&tilt_deg=-12.5");
  ASSERT_TRUE(options.is_ok()) << options.status().message();
  EXPECT_EQ(options->selector, "A00362A08602047A");
  EXPECT_EQ(options->depth, DepthMode::kRaw);
  EXPECT_EQ(options->color.exposure_us, 8000);
  EXPECT_EQ(options->color.gain, 2.5);
  EXPECT_EQ(options->color.auto_white_balance, false);
  EXPECT_FALSE(options->is_led_status);
  EXPECT_EQ(options->fixed_led, Led::kOff);
  EXPECT_EQ(options->tilt_deg, -12.5);
  EXPECT_EQ(options_of("kinect://1?depth=off&led=keep&auto_exposure=0")->depth, DepthMode::kOff);
  EXPECT_FALSE(options_of("kinect://1?led=keep")->fixed_led);
}

TEST(KinectOptions, MistakesAreNamed) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"kinect://?dept=raw", "dept"},
      {"kinect://?depth=metric", "registered, raw, off"},
      {"kinect://?exposure_us=0", "100 to 33000"},
      {"kinect://?gain=17", "1 to 16"},
      {"kinect://?led=blue", "green"},
      {"kinect://?tilt_deg=90", "-31 to 31"},
      {"kinect://?auto_exposure=yes", "0, 1"},
      {"kinect://?auto_exposure=1&exposure_us=5000", "contradicts"},
  };
  for (const auto& [url, hint] : mistakes) {
    const Result<KinectOptions> options = options_of(url);
    ASSERT_FALSE(options.is_ok()) << url;
    EXPECT_EQ(options.status().code(), ErrorCode::kInvalid) << url;
    EXPECT_NE(options.status().message().find(hint), std::string::npos) << options.status().message();
  }
}

TEST(KinectOptions, MistakesAreFoundBeforeTheDeviceIsLookedFor) {
  EXPECT_EQ(open_frame_source("kinect://?depth=metric").status().code(), ErrorCode::kInvalid);
}

TEST(KinectMotor, AccelerationPointsUpInTheCamerasAxes) {
  // Level: y of the sensor reads 1 g. The camera's y points down.
  const std::uint8_t level[kMotorStateBytes] = {0, 0, 0, 0, 0x03, 0x33, 0, 0, 0, 0};
  const auto up = parse_acceleration(level);
  ASSERT_TRUE(up);
  EXPECT_NEAR(up->y(), -kStandardGravity, 0.01);
  EXPECT_NEAR(up->x(), 0, 1e-9);
  EXPECT_NEAR(up->z(), 0, 1e-9);
  // Looking straight down, up is behind the camera: -z of the sensor, which looks along the view.
  const std::uint8_t down[kMotorStateBytes] = {0, 0, 0, 0, 0, 0, 0xfc, 0xcd, 0, 0};
  ASSERT_TRUE(parse_acceleration(down));
  EXPECT_NEAR(parse_acceleration(down)->z(), -kStandardGravity, 0.01);
}

TEST(KinectMotor, NonsenseIsNoAcceleration) {
  const std::uint8_t wild[kMotorStateBytes] = {0, 0, 0x7f, 0xff, 0x7f, 0xff, 0x80, 0, 0, 0};
  EXPECT_FALSE(parse_acceleration(wild));
  EXPECT_FALSE(parse_acceleration(std::span(wild).first(9)));
  EXPECT_FALSE(parse_acceleration({}));
}

}  // namespace
}  // namespace camloc::kinect
