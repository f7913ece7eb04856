// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Checks across settings, calibration and source.
#include "daemon/service_setup.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include "core/io/camera_file.h"
#include "drivers/sample_source.h"
#include "tests/coarse/sample_model.h"
#include "tests/daemon/sample_map.h"
#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::TestFolder;

Config sample_config(const std::string& url = "sample://?width=320&height=240") {
  Config config;
  config.source_url = url;
  return config;
}

FrameSourceInfo source_of(int width, int height) {
  FrameSourceInfo info;
  info.color_width = info.depth_width = width;
  info.color_height = info.depth_height = height;
  return info;
}

TEST(ServiceSetupTest, OptionsFollowTheConfig) {
  Config config = sample_config();
  config.source_lossless = true;
  config.source_retry_ms = 50;
  config.localize_features = 321;
  config.localize_tracking = false;
  config.localize_max_coast_ms = 70;
  config.publish_frame = "wcs";
  config.publish_bot_core_channel = "B";
  EXPECT_TRUE(capture_options(config).wait_for_reader);
  EXPECT_EQ(capture_options(config).retry.count(), 50);
  const MapSlotOptions map = map_slot_options(config);
  EXPECT_EQ(map.localizer.orb.num_features, 321);
  EXPECT_FALSE(map.localizer.use_tracking);
  EXPECT_EQ(map.localizer.max_coast_ns, 70'000'000);
  EXPECT_TRUE(map.needs_datum);
  EXPECT_EQ(sink_options(config).bot_core_channel, "B");
}

TEST(ServiceSetupTest, UnknownSchemeIsAConfigurationError) {
  const Status status = check_settings(sample_config("telepathy://0"));
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("telepathy"), std::string::npos);
  EXPECT_NE(status.message().find("sample"), std::string::npos) << "names what there is: " << status.message();
  EXPECT_TRUE(check_settings(sample_config("sample://")));
  EXPECT_TRUE(check_settings(sample_config("/a/folder")));
  EXPECT_TRUE(check_settings(sample_config("")));
}

TEST(ServiceSetupTest, ACoarseModelIsCheckedWithTheConfiguration) {
  const TestFolder folder;
  Config config = sample_config("");
  config.map_path = folder.file("none.cmap");
  config.coarse_cnn = folder.file("none.onnx");
  EXPECT_NE(check_config(config).message().find("coarse.cnn: "), std::string::npos);
  ASSERT_TRUE(write_onnx(config.coarse_cnn, sample_onnx()));
  ::setenv("CAMLOC_NETWORK_PLUGIN", "/nowhere.so", 1);
  EXPECT_NE(check_config(config).message().find("camloc-coarse"), std::string::npos);
  ::setenv("CAMLOC_NETWORK_PLUGIN", "/proc/self/exe", 1);
  EXPECT_TRUE(check_config(config)) << "a map that is missing is no fault of the model";
  ASSERT_TRUE(testing::write_sample_map({}, config.map_path));
  EXPECT_NE(check_config(config).message().find("is for map 00000000000000ab"), std::string::npos);
  ::unsetenv("CAMLOC_NETWORK_PLUGIN");
}

TEST(ServiceSetupTest, LcmUrlNeedsAProvider) {
  Config config;
  for (const char* url : {"239.255.76.67", "nonsense://x", "://"}) {
    config.publish_lcm_url = url;
    const Status status = check_settings(config);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << url;
    EXPECT_NE(status.message().find("publish.lcm_url: '" + std::string(url) + "' has no provider"), std::string::npos) << status.message();
  }
}

TEST(ServiceSetupTest, HintsOverLcmStayOnThisMachine) {
  Config config;
  config.control_hint_channel = "CAMLOC_HINT";
  EXPECT_TRUE(check_settings(config)) << "the default URL has ttl=0";
  for (const char* url : {"udpm://239.255.76.67:7667?ttl=1", "udpm://239.255.76.67:7667", "udpm://239.255.76.67:7667?ttl=00",
                          "udpm://239.255.76.67:7667?ttl=0&ttl=1", "tcpq://localhost:7700?ttl=0"}) {
    config.publish_lcm_url = url;
    const Status status = check_settings(config);
    EXPECT_EQ(status.code(), ErrorCode::kInvalid) << url;
    EXPECT_NE(status.message().find("control.hint_channel"), std::string::npos) << status.message();
  }
}

TEST(ServiceSetupTest, SourceOwnCalibrationIsUsed) {
  FrameSourceInfo info = source_of(320, 240);
  info.camera = sample_camera(320, 240);
  const Result<RgbdCamera> camera = match_camera(sample_config(), std::nullopt, info);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera.value().color.width, 320);
}

TEST(ServiceSetupTest, NoCalibrationAtAllIsAnError) {
  const Status status = match_camera(sample_config("replay://x"), std::nullopt, source_of(320, 240)).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("source.camera"), std::string::npos);
}

TEST(ServiceSetupTest, AnotherImageSizeIsAnErrorThatNamesBoth) {
  Config config = sample_config();
  config.source_camera = "kinect.toml";
  const Status status = match_camera(config, sample_camera(640, 480), source_of(320, 240)).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  EXPECT_NE(status.message().find("320 x 240"), std::string::npos);
  EXPECT_NE(status.message().find("640 x 480"), std::string::npos);
  EXPECT_NE(status.message().find("kinect.toml"), std::string::npos);
  FrameSourceInfo depth = source_of(640, 480);
  depth.depth_width = 321;
  EXPECT_NE(match_camera(config, sample_camera(640, 480), depth).status().message().find("depth"), std::string::npos);
}

TEST(ServiceSetupTest, SizeOfALiveCameraIsNotKnownBeforeItsFirstFrame) {
  EXPECT_TRUE(match_camera(sample_config(), sample_camera(640, 480), source_of(0, 0)));
}

TEST(ServiceSetupTest, CameraFileIsReadAndChecked) {
  const TestFolder folder;
  Config config = sample_config();
  EXPECT_FALSE(read_configured_camera(config).value().has_value());
  config.source_camera = folder.file("none.toml");
  const Status missing = check_config(config);
  EXPECT_NE(missing.message().find("source.camera"), std::string::npos);
  EXPECT_NE(missing.message().find("none.toml"), std::string::npos);
  config.source_camera = folder.write("camera.toml", format_camera_toml(sample_camera(320, 240)));
  EXPECT_TRUE(check_config(config)) << check_config(config).message();
  config.source_camera = folder.write("other.toml", format_camera_toml(sample_camera(640, 480)));
  EXPECT_NE(check_config(config).message().find("640 x 480"), std::string::npos);
}

TEST(ServiceSetupTest, MissingRecordingIsFoundByTheCheck) {
  EXPECT_FALSE(check_config(sample_config("replay:///nowhere/at/all")));
  EXPECT_FALSE(check_config(sample_config("sample://?nonsense=1")));
}

TEST(ServiceSetupTest, ChangesThatNeedARestartAreNamed) {
  const Config from;
  Config to;
  EXPECT_EQ(changes_that_need_restart(from, to), "");
  to.map_path = "other.cmap";
  EXPECT_EQ(changes_that_need_restart(from, to), "");
  to.source_url = "sample://";
  to.control_socket = "";
  EXPECT_EQ(changes_that_need_restart(from, to), "source.url, control.socket");
}

}  // namespace
}  // namespace camloc
