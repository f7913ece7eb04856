// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What can be wrong with what was configured.
#include <gtest/gtest.h>

#include "tests/tools/command_runner.h"
#include "tests/tools/expect_check.h"

namespace camloc::tools {
namespace {

TEST(DoctorSetupTest, CalibrationOfAnotherImageSize) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "c.toml",
      "[color]\nwidth = 64\nheight = 48\nfx = 50.0\nfy = 50.0\ncx = 32.0\ncy = 24.0\nlens = \"pinhole\"\n[depth]\nregistered = true\n");
  expect(check_calibration(path, std::nullopt, ImageSize{64, 48}), Level::kOk, path);
  expect(check_calibration(path, std::nullopt, std::nullopt), Level::kOk, path);
  expect(check_calibration(path, std::nullopt, ImageSize{640, 480}), Level::kFailure, "is for 64x48 pixels, the camera gives 640x480",
         "camloc camera calibrate");
  expect(check_calibration(folder / "none.toml", std::nullopt, std::nullopt), Level::kFailure, "none.toml", "set another");
  const nlohmann::ordered_json answer{{"is_calibration_suspect", true}, {"focal_scale", 1.17}};
  expect(check_calibration(path, answer, std::nullopt), Level::kWarning, "1.170 times", "calibrate");
}

TEST(DoctorSetupTest, SchemeOfTheSource) {
  Settings settings;
  EXPECT_EQ(settings.scheme(), "");
  settings.source_url = "kinect://A00366A";
  EXPECT_EQ(settings.scheme(), "kinect");
  settings.source_url = "/data/walk";
  EXPECT_EQ(settings.scheme(), "replay");
}

TEST(DoctorSetupTest, AMapThatIsNoneAndASourceThatIsNotThere) {
  const TemporaryFolder folder;
  expect(check_map(""), Level::kFailure, "none configured", "camloc map build");
  expect(check_map(folder.write("m.cmap", "no map")), Level::kFailure, "m.cmap", "copy it again");
  std::optional<ImageSize> size;
  expect(check_source("", std::nullopt, &size), Level::kFailure, "none configured", "camlocd.toml(5)");
  expect(check_source("telepathy://", std::nullopt, &size), Level::kFailure, "telepathy", "camloc camera list");
  EXPECT_FALSE(size);
  expect(check_source("sample://?width=64&height=48&rate_hz=0", std::nullopt, &size), Level::kOk, "64x48 image, 64x48 depth");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 64);
  expect(check_source("kinect://", nlohmann::ordered_json{{"state", "LOST"}}, &size), Level::kOk, "in use by camlocd");
  expect(check_source("kinect://", nlohmann::ordered_json{{"state", "NO_CAMERA"}}, &size), Level::kFailure, "gets no frames", "journalctl");
}

}  // namespace
}  // namespace camloc::tools
