// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/command_runner.h"
#include "tools/camloc/commands.h"

namespace camloc::tools {
namespace {

using nlohmann::json;

json frames_example() { return json::parse(run_command(add_frames_command, {"frames", "--json"}).out); }

void expect_near(const json& values, const std::vector<double>& expected) {
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i].get<double>(), expected[i], 5e-5) << "entry " << i;
}

// Worked out by hand: the camera at (2, 1, 1.6) looks 20 degrees to the left of x; the point at (5, 2.4, 1.9) is 3.2979 m
// ahead, 0.2895 m to the left and 0.3 m above.
constexpr double kAhead = 3.297906, kLeft = 0.289509, kAbove = 0.3;

TEST(FramesTest, PointInCameraIsWhatTrigonometrySays) {
  const double yaw_rad = std::acos(-1.0) / 9;
  EXPECT_NEAR(kAhead, 3 * std::cos(yaw_rad) + 1.4 * std::sin(yaw_rad), 1e-6);
  EXPECT_NEAR(kLeft, -3 * std::sin(yaw_rad) + 1.4 * std::cos(yaw_rad), 1e-6);
  expect_near(frames_example()["p_camera"], {-kLeft, -kAbove, kAhead});
}

TEST(FramesTest, PixelFollowsThePinholeEquation) {
  expect_near(frames_example()["pixel"], {319.5 - 525 * kLeft / kAhead, 239.5 - 525 * kAbove / kAhead});
}

TEST(FramesTest, TranslationIsTheCameraCentre) {
  const json T = frames_example()["T_map_camera"];
  EXPECT_NEAR(T[0][3].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(T[1][3].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(T[2][3].get<double>(), 1.6, 1e-12);
}

TEST(FramesTest, EveryConventionNamesTheSamePoint) {
  const json conventions = frames_example()["conventions"];
  expect_near(conventions["ROS body (REP-103)"]["p"], {kAhead, kLeft, kAbove});
  expect_near(conventions["OpenGL, ARKit, WebXR eye"]["p"], {-kLeft, kAbove, -kAhead});
  expect_near(conventions["Unity, Irrlicht"]["p"], {-kLeft, kAbove, kAhead});
  expect_near(conventions["Unreal"]["p"], {kAhead, -kLeft, kAbove});
  EXPECT_TRUE(conventions["ROS body (REP-103)"]["is_right_handed"].get<bool>());
  EXPECT_TRUE(conventions["OpenGL, ARKit, WebXR eye"]["is_right_handed"].get<bool>());
  EXPECT_FALSE(conventions["Unity, Irrlicht"]["is_right_handed"].get<bool>());
  EXPECT_FALSE(conventions["Unreal"]["is_right_handed"].get<bool>());
}

TEST(FramesTest, EveryEngineDrawsThePointOnItsPixel) {
  const json example = frames_example();
  EXPECT_EQ(example["engines"].size(), 7U);
  for (const auto& [name, engine] : example["engines"].items()) {
    EXPECT_NEAR(engine["pixel"][0].get<double>(), example["pixel"][0].get<double>(), 1e-9) << name;
    EXPECT_NEAR(engine["pixel"][1].get<double>(), example["pixel"][1].get<double>(), 1e-9) << name;
  }
}

TEST(FramesTest, AnEnginesMatricesAreShownOrTheEnginesThereAre) {
  const CommandOutput output = run_command(add_frames_command, {"frames", "--engine", "opengl"});
  EXPECT_NE(output.out.find("projection"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("= 273.41 191.74"), std::string::npos) << output.out;
  EXPECT_EQ(run_command(add_frames_command, {"frames", "--engine", "quake"}).exit_code, 2);
}

TEST(FramesTest, TextShowsTheComputedNumbers) {
  const CommandOutput output = run_command(add_frames_command, {"frames"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_NE(output.out.find("= 273.41"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("= 191.74"), std::string::npos) << output.out;
  EXPECT_NE(output.out.find("[-0.0200 +0.0000 +0.0000  +0.0000 +0.0000 -0.0100]"), std::string::npos) << output.out;
}

}  // namespace
}  // namespace camloc::tools
